//! The effects that can be simulated, estimated and diagnosed, as a document.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tautline_core::effect::{Effect, EffectParameter, Scope, Search, every_effect};
use tautline_core::robot::Robot;
use tautline_session::VersionedFile;

/// The effects of the catalogue, then the hypotheses of a robot.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct EffectsDocument {
    /// The effects.
    pub effects: Vec<EffectDocument>,
}

/// An effect.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct EffectDocument {
    /// Identifier in files and commands.
    pub effect: String,
    /// Plain title.
    pub title: String,
    /// Possible targets.
    pub on: Scope,
    /// Whether readings can determine the effect.
    pub can_be_estimated: bool,
    /// Search of a diagnosis for the effect.
    pub diagnosed: EffectSearch,
    /// Whether only recordings in motion reveal the effect.
    pub in_motion: bool,
    /// Whether the effect is damage, to be repaired rather than modelled: something is loose, broke or moved.
    pub is_damage: bool,
    /// Parameters of the effect.
    pub parameters: Vec<EffectParameterDocument>,
    /// An independent check in the workshop that confirms the effect or rules it out; null if there is none.
    pub check: Option<String>,
    /// Source of the model.
    pub source: String,
}

/// Search of a diagnosis for an effect.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum EffectSearch {
    /// Always, by its size.
    Always,
    /// As a wave of any phase.
    AnyPhase,
    /// As a wave of any phase and period.
    AnyPhaseAndPeriod,
    /// As a step at each pose.
    FromEveryPose,
    /// As an event at each single pose.
    AtEveryPose,
    /// As an error of each single distance between poses.
    AtEveryDistance,
    /// Only if residuals are huge.
    HugeResiduals,
}

/// A parameter of an effect.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct EffectParameterDocument {
    /// Name in files.
    pub name: String,
    /// SI unit; `1` for a ratio.
    pub unit: String,
    /// Whether the parameter has to be given, as the label of a pose, rather than estimated.
    pub is_given: bool,
    /// Value without the effect.
    pub neutral: f64,
    /// Range of sizes typical in practice.
    pub typical: [f64; 2],
    /// Deviation of sound parts, as a standard deviation on a small and on a large machine; null if they do not deviate.
    pub tolerance: Option<[f64; 2]>,
}

impl VersionedFile for EffectsDocument {
    const FORMAT: &'static str = "tautline-effects";
    const VERSION: u32 = 1;
    const MAX_BYTES: u64 = 16 << 20;
}

impl EffectsDocument {
    /// The effects that `robot` can have.
    #[must_use]
    pub fn of(robot: &Robot) -> Self {
        let effects = every_effect().chain(robot.hypothesis_effects());
        Self {
            effects: effects.map(EffectDocument::of).collect(),
        }
    }
}

impl EffectDocument {
    fn of(effect: &'static Effect) -> Self {
        Self {
            effect: effect.id().to_owned(),
            title: effect.title().to_owned(),
            on: effect.scope(),
            can_be_estimated: effect.is_estimable(),
            diagnosed: match effect.search() {
                Search::Direct => EffectSearch::Always,
                Search::Wave { period: None, .. } => EffectSearch::AnyPhase,
                Search::Wave { .. } => EffectSearch::AnyPhaseAndPeriod,
                Search::FromPose(_) => EffectSearch::FromEveryPose,
                Search::AtPose(_) => EffectSearch::AtEveryPose,
                Search::AtDistance(_) => EffectSearch::AtEveryDistance,
                Search::Exchange => EffectSearch::HugeResiduals,
            },
            in_motion: effect.is_in_motion(),
            is_damage: effect.is_damage(),
            parameters: effect.parameters().iter().map(parameter).collect(),
            check: effect.check().map(str::to_owned),
            source: effect.source().to_owned(),
        }
    }
}

fn parameter(parameter: &EffectParameter) -> EffectParameterDocument {
    EffectParameterDocument {
        name: parameter.name.to_owned(),
        unit: parameter.unit.to_owned(),
        is_given: parameter.discrete,
        neutral: parameter.neutral,
        typical: parameter.typical,
        tolerance: parameter.tolerance.map(|t| [t.small, t.large]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tautline_core::robot::presets;

    #[test]
    fn a_hypothesis_follows_the_catalogue() {
        let mut robot = presets::find("mini").expect("a preset").robot;
        let catalogue = EffectsDocument::of(&robot).effects.len();
        assert_eq!(catalogue, every_effect().count());
        let text = "id = \"own\"\ntitle = \"Own\"\nscope = \"cable\"\ncause = \"{cable}: {share}\"\nworkshop = \"Look.\"\n\
                    [parameters.share]\nunit = \"1\"\ntypical = [0.001, 0.01]\n[change]\npaid = \"paid + share * paid\"\n";
        robot.hypotheses.push(text.to_owned());
        let effects = EffectsDocument::of(&robot).effects;
        assert_eq!(effects[catalogue].effect, "own");
        assert_eq!(effects[catalogue].parameters[0].typical, [0.001, 0.01]);
    }

    #[test]
    fn what_cannot_be_estimated_says_so() {
        let robot = presets::find("mini").expect("a preset").robot;
        let effects = EffectsDocument::of(&robot).effects;
        let find = |id: &str| effects.iter().find(|e| e.effect == id).expect("an effect");
        assert!(find("winch_scale").can_be_estimated);
        assert!(!find("cable_swap").can_be_estimated);
        assert_eq!(find("cable_swap").on, Scope::Pair);
        let slip = find("cable_slip").parameters.iter();
        let given: Vec<_> = slip.filter(|p| p.is_given).map(|p| &p.name).collect();
        assert_eq!(given, ["pose"]);
    }
}

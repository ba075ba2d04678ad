//! `--effect`: effects to hide in simulated data or to estimate in an identification.

use crate::BadInput;
use crate::output::note;
use anyhow::Result;
use tautline_core::effect::{BoundEffect, EffectError, EffectRequest, EffectSetting, every_effect};
use tautline_core::measurement::Dataset;
use tautline_core::robot::Robot;
use tautline_session::IdentificationSettings;

/// Effects to simulate.
#[derive(Debug, Default, clap::Args)]
pub struct HiddenEffects {
    /// Simulate a fault: give the robot this effect, on all cables unless one is named; may be repeated
    #[arg(
        long = "effect",
        alias = "effects",
        value_name = "ID[:CABLE][:NAME=NUMBER,..]"
    )]
    texts: Vec<String>,
}

/// Effects to estimate.
#[derive(Debug, Default, clap::Args)]
pub struct EstimatedEffects {
    /// Also estimate this effect, on each cable unless one is named, or two of a pair; parameters that cannot be estimated must be given, such
    /// as the pose of a slip: cable_slip:cable-3:pose=12; may be repeated, or several effects separated by commas
    #[arg(
        long = "effect",
        alias = "effects",
        value_name = "ID[:CABLE][:NAME=NUMBER,..]"
    )]
    texts: Vec<String>,
}

impl HiddenEffects {
    pub fn is_empty(&self) -> bool {
        self.texts.is_empty()
    }

    /// The effects; parameters that are not given are neutral.
    pub fn settings(&self, robot: &Robot) -> Result<Vec<EffectSetting>> {
        let mut settings = Vec::new();
        for one in self.texts.iter().flat_map(|text| split(text)) {
            let bad = |error: EffectError| refused(&one, &error);
            let setting = EffectSetting::parse(&one);
            let bound = setting.and_then(|setting| BoundEffect::from_setting(&setting, robot));
            let bound = bound.map_err(bad)?;
            for question in unusual_sizes(&bound) {
                note!("--effect {one}: {question}");
            }
            settings.push(bound.setting(robot));
        }
        Ok(settings)
    }
}

impl EstimatedEffects {
    pub fn is_empty(&self) -> bool {
        self.texts.is_empty()
    }

    /// The effects at their start values, one for each cable if the effect is per cable and no cable is
    /// named; without an argument those of the session. Poses that they refer to must be in the data.
    pub fn settings(
        &self,
        dataset: &Dataset,
        of_session: &IdentificationSettings,
    ) -> Result<Vec<EffectSetting>> {
        if self.is_empty() {
            return Ok(of_session.effects.clone());
        }
        let bound = self.bind(&dataset.robot)?;
        for effect in &bound {
            effect
                .check_poses(&dataset.measurements)
                .map_err(|error| BadInput::new(format!("--effect: {error}")))?;
        }
        let settings = bound.iter().map(|effect| effect.setting(&dataset.robot));
        Ok(settings.collect())
    }

    /// The effects attached to the robot.
    pub fn bind(&self, robot: &Robot) -> Result<Vec<BoundEffect>> {
        let mut bound = Vec::new();
        for one in self.texts.iter().flat_map(|text| split(text)) {
            let instances = EffectRequest::parse(&one).and_then(|request| request.bind(robot));
            let bad = |error: EffectError| refused(&one, &error);
            bound.extend(instances.map_err(bad)?);
        }
        Ok(bound)
    }
}

/// Similarity from which a name is suggested for an unknown effect: names that only begin alike have less.
const SIMILAR: f64 = 0.9;

/// The error of an effect, with the name that was probably meant.
fn refused(text: &str, error: &EffectError) -> anyhow::Error {
    let nearest = match error {
        EffectError::UnknownEffect(id) => {
            let likeness = |known: &str| strsim::jaro_winkler(id, known);
            let known = every_effect().map(|effect| (likeness(effect.id()), effect.id()));
            known.max_by(|a, b| a.0.total_cmp(&b.0))
        }
        _ => None,
    };
    let nearest = nearest.filter(|(likeness, _)| *likeness > SIMILAR);
    let hint = nearest.map_or_else(String::new, |(_, id)| format!("; did you mean {id}?"));
    BadInput::new(format!("--effect {text}: {error}{hint}"))
}

/// Factor of the largest typical size above which a value is questioned.
const UNUSUAL: f64 = 10.0;

/// Questions about values far beyond typical sizes, such as percent where a ratio is expected.
fn unusual_sizes(bound: &BoundEffect) -> impl Iterator<Item = String> {
    let parameters = bound.effect.parameters().iter().zip(&bound.values);
    parameters.filter_map(|(parameter, value)| {
        let typical = parameter.typical;
        let is_unusual = !parameter.discrete
            && typical[1] > 0.0
            && (value - parameter.neutral).abs() > UNUSUAL * typical[1];
        let unit = match parameter.unit {
            "1" => String::new(),
            unit => format!(" {unit}"),
        };
        let is_percent = parameter.unit == "1";
        is_unusual.then(|| {
            let name = parameter.name;
            let as_percent = if is_percent {
                format!(", which is {} %; 1 % is {name}=0.01", 100.0 * value)
            } else {
                String::new()
            };
            format!(
                "found {name}={value}{as_percent}: typical sizes are {} to {}{unit}",
                typical[0], typical[1]
            )
        })
    })
}

/// Splits an argument into effects: a comma starts another effect unless a parameter `NAME=NUMBER` follows it.
fn split(text: &str) -> Vec<String> {
    let mut effects: Vec<String> = Vec::new();
    for part in text.split(',') {
        let name = part.split(':').next().unwrap_or_default();
        match effects.last_mut() {
            Some(last) if name.contains('=') => {
                last.push(',');
                last.push_str(part);
            }
            _ => effects.push(part.to_owned()),
        }
    }
    effects
}

#[cfg(test)]
mod tests {
    use clap::Parser;
    use tautline_core::robot::presets;

    use super::*;

    #[derive(Debug, Parser)]
    struct Freed {
        #[command(flatten)]
        effects: EstimatedEffects,
    }

    #[derive(Debug, Parser)]
    struct Hidden {
        #[command(flatten)]
        effects: HiddenEffects,
    }

    #[test]
    fn sizes_far_from_typical_ones_are_questioned() {
        let robot = presets::find("mini").expect("a preset").robot;
        let questions = |text: &str| -> Vec<String> {
            let setting = EffectSetting::parse(text).expect("a setting");
            let bound = BoundEffect::from_setting(&setting, &robot).expect("an effect");
            unusual_sizes(&bound).collect()
        };
        assert_eq!(
            questions("winch_scale:cable-3:scale=2"),
            ["found scale=2, which is 200 %; 1 % is scale=0.01: typical sizes are 0.001 to 0.03"]
        );
        assert!(questions("winch_scale:cable-3:scale=0.02").is_empty());
        assert_eq!(questions("laser_bias:bias=40").len(), 1);
        assert!(questions("cable_slip:cable-3:pose=900,step=0.01").is_empty());
    }

    fn freed(arguments: &[&str]) -> Result<Vec<EffectSetting>> {
        let arguments = Freed::parse_from([&["tautline"], arguments].concat());
        let robot = presets::find("planar").expect("a preset").robot;
        let bound = arguments.effects.bind(&robot)?;
        Ok(bound.iter().map(|effect| effect.setting(&robot)).collect())
    }

    #[test]
    fn both_names_of_the_flag_take_one_effect_or_a_list() {
        let expected = freed(&["--effect", "winch_scale:cable-2", "--effect", "laser_scale"]);
        let expected = expected.expect("effects");
        assert_eq!(expected.len(), 2);
        for arguments in [
            &["--effect", "winch_scale:cable-2,laser_scale"][..],
            &["--effects", "winch_scale:cable-2,laser_scale"],
            &[
                "--effects",
                "winch_scale:cable-2",
                "--effect",
                "laser_scale",
            ],
        ] {
            assert_eq!(
                freed(arguments).expect("effects"),
                expected,
                "{arguments:?}"
            );
        }
        assert_eq!(
            freed(&["--effect", "winch_scale"]).expect("effects").len(),
            4
        );
    }

    #[test]
    fn parameters_may_be_separated_by_commas_or_colons() {
        let expected = freed(&[
            "--effect",
            "cable_slip:cable-2:pose=2,step=0.003,laser_scale",
        ]);
        let expected = expected.expect("effects");
        assert_eq!(expected.len(), 2);
        assert_eq!(expected[0].parameters["step"], 0.003);
        let other = freed(&[
            "--effects",
            "cable_slip:cable-2:pose=2:step=0.003,laser_scale",
        ]);
        assert_eq!(other.expect("effects"), expected);
    }

    #[test]
    fn two_cables_can_be_exchanged_in_simulated_data() {
        let robot = presets::find("planar").expect("a preset").robot;
        let text = "cable_swap:cable-1:cable-2";
        for flag in ["--effect", "--effects"] {
            let arguments = Hidden::parse_from(["tautline", flag, text]);
            let settings = arguments.effects.settings(&robot).expect("an effect");
            assert_eq!(settings[0].targets, ["cable-1", "cable-2"]);
        }
    }

    #[test]
    fn what_is_wrong_is_named() {
        for (text, expected) in [
            (
                "winch_scale:scale=much",
                "found \"scale=much\", expected NAME=NUMBER",
            ),
            ("winch_skale", "unknown effect"),
            ("winch_scale:cable-9", "no cable \"cable-9\""),
            ("winch_scale:cable-1:cable-2", "expected one cable"),
        ] {
            let error = freed(&["--effect", text]).expect_err(text).to_string();
            assert!(error.starts_with(&format!("--effect {text}: ")), "{error}");
            assert!(error.contains(expected), "{error}");
        }
    }
}

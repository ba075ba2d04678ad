//! Tolerances of the parts: permitted deviations from the description.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Tolerances of all parts, in `robot.json` under `tolerances`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(
    untagged,
    expecting = "expected \"typical\" or an object of effects with standard deviations"
)]
pub enum PartTolerances {
    /// Those of the catalogue, for the robot's class of machine.
    Typical(Typical),
    /// Stated tolerances.
    Stated(StatedTolerances),
}

/// The word that stands for the tolerances of the catalogue.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Typical {
    /// `"typical"`.
    Typical,
}

/// Stated tolerances by effect, as standard deviations in the unit of its parameters. Effects that are not stated have
/// none.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct StatedTolerances {
    /// Common factor of all tolerances.
    #[serde(default = "one")]
    pub factor: f64,
    /// Tolerance of each effect.
    #[serde(flatten)]
    pub effects: BTreeMap<String, Tolerance>,
}

fn one() -> f64 {
    1.0
}

/// The tolerance of one effect.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(
    untagged,
    expecting = "expected a standard deviation, or an object of cables with standard deviations"
)]
pub enum Tolerance {
    /// The same for all targets.
    Same(f64),
    /// By cable name; `default` is for all other cables.
    ByCable(BTreeMap<String, f64>),
}

/// Key of the cables that are not named.
pub(crate) const OTHER_CABLES: &str = "default";

impl PartTolerances {
    /// The tolerances of the catalogue.
    #[must_use]
    pub fn typical() -> Self {
        Self::Typical(Typical::Typical)
    }

    /// No tolerances: every part is exactly as described.
    #[must_use]
    pub fn exact() -> Self {
        Self::Stated(StatedTolerances {
            factor: 1.0,
            effects: BTreeMap::new(),
        })
    }
}

impl StatedTolerances {
    /// Stated standard deviation of an effect on a cable, without the factor; 0 if none is stated. `cable` is `None` for
    /// effects of the whole robot.
    #[must_use]
    pub fn sd_of(&self, effect: &str, cable: Option<&str>) -> f64 {
        match (self.effects.get(effect), cable) {
            (Some(Tolerance::Same(sd)), _) => *sd,
            (Some(Tolerance::ByCable(by_cable)), Some(cable)) => {
                let named = by_cable.get(cable).or_else(|| by_cable.get(OTHER_CABLES));
                named.copied().unwrap_or(0.0)
            }
            (Some(Tolerance::ByCable(_)) | None, _) => 0.0,
        }
    }

    /// Stated standard deviation of the cables that are not named, or of the robot, without the factor.
    #[must_use]
    pub fn others(&self, effect: &str) -> Option<f64> {
        match self.effects.get(effect)? {
            Tolerance::Same(sd) => Some(*sd),
            Tolerance::ByCable(by_cable) => by_cable.get(OTHER_CABLES).copied(),
        }
    }

    /// The cables that are named for an effect, with their standard deviations, without the factor.
    pub fn named(&self, effect: &str) -> impl Iterator<Item = (&str, f64)> {
        let by_cable = match self.effects.get(effect) {
            Some(Tolerance::ByCable(by_cable)) => Some(by_cable),
            Some(Tolerance::Same(_)) | None => None,
        };
        let named = by_cable.into_iter().flatten();
        let named = named.filter(|(cable, _)| *cable != OTHER_CABLES);
        named.map(|(cable, sd)| (cable.as_str(), *sd))
    }

    /// States the standard deviation of all cables that are not named, or of the robot; `None`: they have no tolerance.
    pub fn set_others(&mut self, effect: &str, sd: Option<f64>) {
        match (self.effects.get_mut(effect), sd) {
            (Some(Tolerance::ByCable(by_cable)), Some(sd)) => {
                by_cable.insert(OTHER_CABLES.to_owned(), sd);
            }
            (Some(Tolerance::ByCable(by_cable)), None) => {
                by_cable.remove(OTHER_CABLES);
            }
            (_, Some(sd)) => {
                self.effects.insert(effect.to_owned(), Tolerance::Same(sd));
            }
            (_, None) => {
                self.effects.remove(effect);
            }
        }
    }

    /// Changes the standard deviation of a named cable; `None`: it is one of the others again.
    pub fn set_named(&mut self, effect: &str, cable: &str, sd: Option<f64>) {
        let Some(Tolerance::ByCable(by_cable)) = self.effects.get_mut(effect) else {
            return;
        };
        match sd {
            Some(sd) => by_cable.insert(cable.to_owned(), sd),
            None => by_cable.remove(cable),
        };
        if by_cable.keys().all(|cable| cable == OTHER_CABLES) {
            let others = by_cable.get(OTHER_CABLES).copied();
            self.effects.remove(effect);
            self.set_others(effect, others);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WINCH: &str = "winch_scale";

    fn stated(tolerance: Tolerance) -> StatedTolerances {
        StatedTolerances {
            factor: 1.0,
            effects: [(WINCH.to_owned(), tolerance)].into(),
        }
    }

    fn by_cable(values: &[(&str, f64)]) -> StatedTolerances {
        let values = values.iter().map(|(cable, sd)| ((*cable).to_owned(), *sd));
        stated(Tolerance::ByCable(values.collect()))
    }

    #[test]
    fn cables_keep_what_is_stated_for_them_alone() {
        let mut tolerances = by_cable(&[("cable-3", 1e-3), (OTHER_CABLES, 2e-4)]);
        tolerances.set_others(WINCH, Some(5e-4));
        assert_eq!(tolerances.sd_of(WINCH, Some("cable-3")), 1e-3);
        assert_eq!(tolerances.sd_of(WINCH, Some("cable-1")), 5e-4);
        tolerances.set_others(WINCH, None);
        assert_eq!(tolerances, by_cable(&[("cable-3", 1e-3)]));
        tolerances.set_named(WINCH, "cable-3", Some(2e-3));
        let named: Vec<_> = tolerances.named(WINCH).collect();
        assert_eq!(named, [("cable-3", 2e-3)]);
        tolerances.set_named(WINCH, "cable-3", None);
        assert!(tolerances.effects.is_empty());
    }

    #[test]
    fn the_last_named_cable_leaves_one_number_for_all() {
        let mut tolerances = by_cable(&[("cable-3", 1e-3), (OTHER_CABLES, 2e-4)]);
        tolerances.set_named(WINCH, "cable-3", None);
        assert_eq!(tolerances, stated(Tolerance::Same(2e-4)));
        tolerances.set_others(WINCH, None);
        assert!(tolerances.effects.is_empty());
    }
}

//! Tolerances of the parts: by how much they may deviate from the description.

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
    /// Stated ones.
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
    /// Factor of all of them.
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
}

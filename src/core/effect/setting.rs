//! An effect with its targets and values in the form of model files.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// One effect of a model: `{"effect": "winch_scale", "targets": ["cable-3"], "parameters": {"scale": 0.0031}}`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct EffectSetting {
    /// Identifier in the catalogue, or of a hypothesis of the robot.
    pub effect: String,
    /// Names of the cables concerned; empty for the robot, the laser or all cables together.
    #[serde(default)]
    pub targets: Vec<String>,
    /// Value of each parameter by name (SI units).
    #[serde(default)]
    pub parameters: BTreeMap<String, f64>,
}

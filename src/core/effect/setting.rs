//! An effect with its targets and values in the form of model files.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::EffectError;

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

impl EffectSetting {
    /// Parses `ID[:CABLE]..[:NAME=NUMBER,...]`; `:` may stand for `,` as well.
    ///
    /// # Errors
    /// If a parameter has no finite number.
    pub fn parse(text: &str) -> Result<Self, EffectError> {
        let mut parts = text.split(':').map(str::trim);
        let mut setting = Self {
            effect: parts.next().unwrap_or_default().to_owned(),
            targets: Vec::new(),
            parameters: BTreeMap::new(),
        };
        for part in parts {
            if !part.contains('=') {
                setting.targets.push(part.to_owned());
                continue;
            }
            for pair in part.split(',') {
                let value = pair
                    .split_once('=')
                    .and_then(|(name, value)| Some((name, value.trim().parse::<f64>().ok()?)));
                let Some((name, value)) = value.filter(|(_, value)| value.is_finite()) else {
                    return Err(EffectError::NoValue(pair.to_owned()));
                };
                let name = name.trim().to_owned();
                setting.parameters.insert(name, value);
            }
        }
        Ok(setting)
    }
}

//! Settings of identification and diagnosis.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tautline_core::effect::EffectSetting;

/// Settings chosen by the operator.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct Settings {
    /// Identification (phase 4).
    pub identification: IdentificationSettings,
    /// Diagnosis of the model.
    pub diagnosis: DiagnosisSettings,
}

/// Settings of the identification.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct IdentificationSettings {
    /// Method of identification.
    pub method: Method,
    /// Effects that the operator added to the model; their parameters are identified, starting from the
    /// values given here or else from their start values.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub effects: Vec<EffectSetting>,
}

/// Method of identification.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Method {
    /// Lengths, tensions and static equilibrium together.
    #[default]
    Joint,
    /// Lengths with the measured tensions taken as exact.
    Simple,
    /// The method of Jin et al. 2018.
    Published,
}

/// Settings of the diagnosis.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct DiagnosisSettings {
    /// Probability of a false alarm.
    pub alpha: f64,
}

impl Default for DiagnosisSettings {
    fn default() -> Self {
        Self { alpha: 0.01 }
    }
}

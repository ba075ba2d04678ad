//! How identification and diagnosis are to work.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tautline_core::effect::EffectSetting;

/// The choices of the operator.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct Settings {
    /// Phase 4.
    pub identification: IdentificationSettings,
    /// The search for hidden effects.
    pub diagnosis: DiagnosisSettings,
}

/// How parameters are identified.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct IdentificationSettings {
    /// Which problem is solved.
    pub method: Method,
    /// Effects that the operator added to the model; their parameters are identified, from the
    /// values given here or else from their start values.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub effects: Vec<EffectSetting>,
}

/// The problem that identification solves.
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

/// How hidden effects are looked for.
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

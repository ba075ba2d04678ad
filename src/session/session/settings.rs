//! Settings of measuring, identification and diagnosis.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tautline_core::effect::EffectSetting;
use tautline_core::sequential::{AT_MOST, Goal};

use super::CertificateDetails;

/// Settings chosen by the operator.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct Settings {
    /// When a measuring run ends (phase 3).
    #[serde(skip_serializing_if = "UntilSettings::is_default")]
    pub until: UntilSettings,
    /// Identification (phase 4).
    pub identification: IdentificationSettings,
    /// Diagnosis of the model.
    pub diagnosis: DiagnosisSettings,
    /// Largest acceptable deviation of a pulley from the drawing (m), by which reports judge.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tolerance_m: Option<f64>,
    /// What its certificate states beside the results.
    #[serde(skip_serializing_if = "is_default")]
    pub certificate: CertificateDetails,
}

fn is_default(details: &CertificateDetails) -> bool {
    *details == CertificateDetails::default()
}

/// When a measuring run ends whose poses are decided on one by one.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct UntilSettings {
    /// Whether poses are decided on one by one; else all planned poses are measured.
    pub enabled: bool,
    /// When to stop: all of them, such as `accuracy=0.3mm`, `cause=95%` or `fault-free=95%`.
    pub goals: Vec<Goal>,
    /// Largest number of poses, the home pose not counted.
    #[schemars(range(min = 1))]
    pub at_most: usize,
    /// Whether only poses of the plan are measured, instead of any of the workspace.
    pub only_planned: bool,
}

impl UntilSettings {
    fn is_default(&self) -> bool {
        *self == Self::default()
    }
}

impl Default for UntilSettings {
    fn default() -> Self {
        Self {
            enabled: false,
            // All later steps depend on whether there is a fault, and on its cause.
            goals: vec![Goal::Cause(0.95)],
            at_most: AT_MOST,
            only_planned: false,
        }
    }
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

//! Machine-readable form of an identification: a public format.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tautline_session::VersionedFile;

use super::budget::BudgetDocument;

/// Machine-readable form of an identification.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct IdentificationDocument {
    /// joint, simple or published.
    pub method: String,
    /// Whether the solver converged.
    pub converged: bool,
    /// Number of steps.
    pub iterations: usize,
    /// Time of the solve alone (s).
    pub seconds: f64,
    /// Chi-square at the solution, priors included.
    pub chi2: f64,
    /// Degrees of freedom.
    pub dof: f64,
    /// Probability of a chi-square at least as large if model and noise are right.
    pub p_value: Option<f64>,
    /// Entry point of each cable (m).
    pub entry_points_m: Vec<[f64; 3]>,
    /// Standard deviations of the entry points (m); 0 where a coordinate was given, null where it is not determined.
    pub entry_points_sd_m: Vec<[Option<f64>; 3]>,
    /// Root mean square residuals; null if not measured.
    pub rms: Rms,
    /// The poses, home first.
    pub poses: Vec<FittedPose>,
    /// Estimated effects.
    #[serde(default)]
    pub effects: Vec<FittedEffect>,
    /// Parameters that the data do not determine, in words.
    #[serde(default)]
    pub undetermined: Vec<String>,
    /// Suspect readings in words, the worst first.
    #[serde(default)]
    pub suspect_readings: Vec<String>,
    /// Budget of the uncertainty.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub budget: Option<BudgetDocument>,
}

/// Root mean square residuals.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Rms {
    /// Residuals of the length readings (m).
    pub length_m: Option<f64>,
    /// Residuals of the laser readings (m).
    pub laser_m: Option<f64>,
    /// Residuals of the tension readings (N).
    pub tension_n: Option<f64>,
    /// Residuals of the distances between poses (m).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub distance_m: Option<f64>,
}

/// One fitted pose.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FittedPose {
    /// Label of the row.
    pub pose: i64,
    /// Platform origin in the base frame (m).
    pub position_m: [f64; 3],
    /// Orientation, quaternion w first.
    pub orientation_wxyz: [f64; 4],
}

/// One estimated parameter of an effect.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FittedEffect {
    /// Effect of the catalogue.
    pub effect: String,
    /// Cables; empty for all.
    pub targets: Vec<String>,
    /// Name of the parameter.
    pub parameter: String,
    /// Value (SI).
    pub value: f64,
    /// Unit.
    pub unit: String,
    /// Standard deviation; null if not determined.
    pub sd: Option<f64>,
}

impl VersionedFile for IdentificationDocument {
    const FORMAT: &'static str = "tautline-identification";
    const VERSION: u32 = 1;
    const MAX_BYTES: u64 = 1 << 30;
}

//! Machine-readable form of a measured home pose: a public format.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tautline_core::instrument::HomeAverage;
use tautline_session::VersionedFile;

/// The mean of all measurements of the home pose.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct HomeDocument {
    /// Number of measurements made now.
    pub measured_now: usize,
    /// Total number of measurements; repeats on the home platform count as one.
    pub measurements: usize,
    /// Mean position (m).
    pub position_m: [f64; 3],
    /// Mean orientation, quaternion w first.
    pub orientation_wxyz: [f64; 4],
    /// Standard deviations of the position (m).
    pub position_sd_m: [f64; 3],
    /// Standard deviations of the rotation vector (rad).
    pub orientation_sd_rad: [f64; 3],
    /// Probability of differences at least as large as those of the measurements; null for a single one.
    pub p_value: Option<f64>,
}

impl VersionedFile for HomeDocument {
    const FORMAT: &'static str = "tautline-home";
    const VERSION: u32 = 1;
    const MAX_BYTES: u64 = 1 << 20;
}

impl HomeDocument {
    /// The document of all measurements, of which `measured_now` were made by this command.
    #[must_use]
    pub fn of(average: &HomeAverage, measured_now: usize) -> Self {
        let (position_sd_m, orientation_sd_rad) = average.sd();
        Self {
            measured_now,
            measurements: average.count,
            position_m: average.pose.position.into(),
            orientation_wxyz: average.pose.orientation_wxyz(),
            position_sd_m,
            orientation_sd_rad,
            p_value: average.p_value(),
        }
    }
}

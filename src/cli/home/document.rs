//! The result of `home`: as a document, and as readable text.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tautline_core::instrument::HomeAverage;
use tautline_session::VersionedFile;
use tautline_workflow::wording::{count, units};

use crate::output::say;

/// Probability below which the scatter of the measurements is reported as doubtful.
const DOUBTFUL: f64 = 0.01;

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

/// Prints the document.
pub fn print(document: &HomeDocument) {
    let position = document.position_m.map(|v| units::mm(v, 3)).join(", ");
    let sds = document.position_sd_m.map(|v| units::mm(v, 3)).join(", ");
    let turned = document.orientation_sd_rad.into_iter().fold(0.0, f64::max);
    say!(
        "home pose by {}: position {position} mm, standard deviations {sds} mm and {:.4}°",
        count(document.measurements, "measurement"),
        turned.to_degrees()
    );
    if let Some(p) = document.p_value.filter(|p| *p < DOUBTFUL) {
        say!(
            "the measurements differ more than their standard deviations say (p = {p:.1e}): the standard deviations of the \
             mean are not valid"
        );
    }
}

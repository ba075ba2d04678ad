//! Machine-readable form of a health check: a public format.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tautline_session::{Timestamp, VersionedFile};

use super::{Baseline, Checked};
use crate::history::Changed;
use crate::readiness::{CheckItem, ReadinessDocument};

/// Verdict of a check on changes of the robot.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum HealthVerdict {
    /// No change is visible.
    Unchanged,
    /// A change is certain, with at least 95 % probability.
    Changed,
    /// These poses leave it undecided.
    Undecided,
}

/// The smallest move of a pulley that a check finds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct DetectableMove {
    /// Name of its cable.
    pub cable: String,
    /// Move in a random direction that is detected with 95 % probability (m); null if no move is.
    pub move_m: Option<f64>,
}

/// A check against a baseline.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct HealthDocument {
    /// Name of the robot.
    pub robot: String,
    /// Whether the readings are complete and plausible.
    pub ready: bool,
    /// Checks of the readings.
    pub checks: Vec<CheckItem>,
    /// Time of the baseline measurement; null if unknown.
    pub baseline_time: Option<Timestamp>,
    /// Verdict on changes of the robot.
    pub verdict: HealthVerdict,
    /// Posterior probability that nothing changed.
    pub probability_unchanged: f64,
    /// Certain and possible changes.
    pub changes: Vec<Changed>,
    /// The smallest moves that this check finds.
    pub detectable: Vec<DetectableMove>,
    /// Positions (m) and orientations (w, x, y, z) of further poses to measure, if the check is undecided.
    pub more_poses: Vec<([f64; 3], [f64; 4])>,
}

impl VersionedFile for HealthDocument {
    const FORMAT: &'static str = "tautline-check";
    const VERSION: u32 = 1;
    const MAX_BYTES: u64 = 1 << 20;
}

impl HealthDocument {
    /// The document of a check whose readings were found to be in order.
    #[must_use]
    pub fn of(readings: ReadinessDocument, baseline: &Baseline, checked: &Checked) -> Self {
        let history = &checked.found.history;
        let robot = &checked.identification.dataset.robot;
        let changes = history.jumps.iter();
        let more = checked.more_poses.iter();
        Self {
            robot: readings.robot,
            ready: readings.ready,
            checks: readings.checks,
            baseline_time: baseline.time,
            verdict: checked.verdict,
            probability_unchanged: history.unchanged,
            changes: changes
                .map(|jump| Changed::of(history, robot, jump))
                .collect(),
            detectable: checked.detectable.clone(),
            more_poses: more
                .map(|pose| (pose.position.into(), pose.orientation_wxyz()))
                .collect(),
        }
    }
}

//! The result of `measure`: as a document, and as readable text.

use std::path::Path;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tautline_session::{Session, VersionedFile};

use super::drive::{RunEnd, RunOutcome};
use crate::output::say;
use tautline_workflow::wording::{count, count_are, units};

/// A measuring run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MeasuringDocument {
    /// How it ended: finished, good_enough, stopped (by the operator) or failed.
    pub end: String,
    /// Labels of all poses that are measured, in the order of measurement.
    pub measured: Vec<i64>,
    /// Labels of those that were measured in this run.
    pub measured_now: Vec<i64>,
    /// Poses that were left out in this run.
    pub skipped: Vec<Skipped>,
    /// Labels of the poses of the plan that are not measured.
    pub missing: Vec<i64>,
    /// Whether the poses measured determine the robot.
    pub enough: bool,
    /// Largest standard deviation of a coordinate of an entry point to which the readings lead (m); null unless
    /// --stop-at asks for it.
    pub largest_sd_m: Option<f64>,
}

/// A pose that was left out.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Skipped {
    /// Its label.
    pub pose: i64,
    /// Why.
    pub reason: String,
}

impl VersionedFile for MeasuringDocument {
    const FORMAT: &'static str = "tautline-measuring";
    const VERSION: u32 = 1;
    const MAX_BYTES: u64 = 64 << 20;
}

impl MeasuringDocument {
    /// Of a run and the session that it left.
    pub fn of(session: &Session, ended: &RunOutcome, enough: bool) -> Self {
        let measured = session.measurements.labels.clone();
        let planned = session.plan.iter().map(|pose| pose.label);
        let skipped = ended.skipped.iter();
        Self {
            end: match ended.end {
                RunEnd::Finished => "finished",
                RunEnd::GoodEnough => "good_enough",
                RunEnd::Interrupted => "stopped",
                RunEnd::Failed(_) | RunEnd::NotTyped(_) => "failed",
            }
            .to_owned(),
            measured_now: ended.measured.clone(),
            skipped: skipped
                .map(|(pose, reason)| Skipped {
                    pose: *pose,
                    reason: reason.clone(),
                })
                .collect(),
            missing: planned.filter(|label| !measured.contains(label)).collect(),
            measured,
            enough,
            largest_sd_m: ended.largest_sd_m,
        }
    }
}

/// Prints it.
pub fn print(document: &MeasuringDocument, session: &Path) {
    say!(
        "{}: {} measured now, {} in all",
        session.display(),
        count(document.measured_now.len(), "pose"),
        document.measured.len()
    );
    for Skipped { pose, reason } in &document.skipped {
        say!("pose {pose} was skipped: {reason}");
    }
    if let Some(sd_m) = document.largest_sd_m {
        say!(
            "largest standard deviation of an entry point's coordinate: {} mm",
            units::mm(sd_m, 2)
        );
    }
    if document.end == "good_enough" {
        let rest = count_are(document.missing.len(), "planned pose");
        say!("the precision is reached: {rest} not needed");
    }
}

//! The result of `measure`: as a document and as human-readable text.

use std::path::Path;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tautline_session::{Session, VersionedFile};

use super::drive::{RunEnd, RunOutcome};
use crate::output::say;
use tautline_workflow::sequential::UntilDocument;
use tautline_workflow::wording::{count, count_are, units};

/// Result of a measuring run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MeasuringDocument {
    /// How it ended: finished, good_enough, decided (see until), stopped (by the operator) or failed.
    pub end: String,
    /// Labels of all measured poses, in the order of measurement.
    pub measured: Vec<i64>,
    /// Labels of the poses measured in this run.
    pub measured_now: Vec<i64>,
    /// Poses skipped in this run.
    pub skipped: Vec<Skipped>,
    /// Labels of the planned poses that are not measured.
    pub missing: Vec<i64>,
    /// Whether the measured poses determine the robot.
    pub enough: bool,
    /// What they lack, in a sentence; null if they determine it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lacking: Option<String>,
    /// Largest standard deviation of a coordinate of an entry point that results from the readings (m); null without
    /// --stop-at.
    pub largest_sd_m: Option<f64>,
    /// What somebody else changed in the controller while poses were measured, one sentence each.
    #[serde(default)]
    pub foreign_writes: Vec<String>,
    /// Goals and decisions; null without --until.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub until: Option<UntilDocument>,
}

/// A pose that was skipped.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Skipped {
    /// Label of the pose.
    pub pose: i64,
    /// Reason.
    pub reason: String,
}

impl VersionedFile for MeasuringDocument {
    const FORMAT: &'static str = "tautline-measuring";
    const VERSION: u32 = 1;
    const MAX_BYTES: u64 = 64 << 20;
}

impl MeasuringDocument {
    /// The document of a run and its session.
    pub fn of(session: &Session, ended: &RunOutcome, lacking: Option<String>) -> Self {
        let measured = session.measurements.labels.clone();
        let planned = session.plan.iter().map(|pose| pose.label);
        Self {
            end: match ended.end {
                RunEnd::Finished => "finished",
                RunEnd::GoodEnough => "good_enough",
                RunEnd::Decided(_) => "decided",
                RunEnd::Interrupted => "stopped",
                RunEnd::Failed(_) | RunEnd::NotTyped(_) => "failed",
            }
            .to_owned(),
            measured_now: ended.measured.clone(),
            skipped: ended.skipped.clone(),
            missing: planned.filter(|label| !measured.contains(label)).collect(),
            measured,
            enough: lacking.is_none(),
            lacking,
            largest_sd_m: ended.largest_sd_m,
            foreign_writes: ended.foreign_writes.clone(),
            until: ended.until.clone(),
        }
    }
}

/// Prints the document.
pub fn print(document: &MeasuringDocument, session: &Path) {
    say!(
        "{}: {} measured now, {} in total",
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
    for text in &document.foreign_writes {
        say!("attention: {text}");
    }
    if document.end == "good_enough" {
        let rest = count_are(document.missing.len(), "planned pose");
        say!("the requested precision is reached: {rest} not needed");
    }
    if let Some(until) = &document.until {
        print_until(until);
    }
}

fn print_until(until: &UntilDocument) {
    for goal in &until.goals {
        let is = if goal.reached {
            "reached"
        } else {
            "not reached"
        };
        say!("{}: {is}", goal.goal);
    }
    for set in &until.sets {
        say!("{:5.1} % {}", 100.0 * set.probability, set.causes);
    }
    for help in &until.help {
        say!("{help}");
    }
}

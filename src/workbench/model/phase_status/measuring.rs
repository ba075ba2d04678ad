//! How far the measured poses are.

use crate::model::OpenSession;
use crate::model::phase::{PhaseStatus, Progress};
use tautline_workflow::planning::missing;
use tautline_workflow::wording::count;

/// How many poses are measured and how many are still planned.
pub(super) fn whole(open: &OpenSession) -> PhaseStatus {
    let session = open.session();
    let measured = session.measurements.len();
    match (measured, missing(session)) {
        (0, 0) => PhaseStatus::new(Progress::NotStarted, "no poses measured"),
        (0, missing) => PhaseStatus::new(
            Progress::NotStarted,
            format!("{} planned", count(missing, "pose")),
        ),
        (_, 0) => PhaseStatus::new(
            Progress::Done,
            format!("{} measured", count(measured, "pose")),
        ),
        (_, missing) => PhaseStatus::new(
            Progress::InProgress,
            format!("{} measured, {missing} to go", count(measured, "pose")),
        ),
    }
}

//! State of the adjustment of the controller.

use tautline_session::{Outcome, Stage};

use crate::model::OpenSession;
use crate::model::phase::{PhaseStatus, Progress};
use tautline_workflow::wording::count;

/// Result of the last adjustment, its verification, and the number of values changed since.
pub(super) fn whole(open: &OpenSession, changes: usize) -> PhaseStatus {
    let session = open.session();
    let verified = |stage: Stage| session.verifications().iter().any(|run| run.stage == stage);
    let Some(last) = session.adjustments().last() else {
        return if verified(Stage::Before) {
            PhaseStatus::new(Progress::InProgress, "measured before the adjustment")
        } else {
            PhaseStatus::new(Progress::NotStarted, "nothing written yet")
        };
    };
    let after =
        |run: &tautline_session::Verification| run.stage == Stage::After && run.time >= last.time;
    match &last.outcome {
        Outcome::Written if open.fit().is_some() && !open.fit_is_current() => {
            PhaseStatus::new(Progress::OutOfDate, "data changed since it was written")
        }
        Outcome::Written if changes > 0 => {
            let line = count(changes, "value") + " not written";
            PhaseStatus::new(Progress::InProgress, line)
        }
        Outcome::Written if session.verifications().iter().any(after) => {
            PhaseStatus::new(Progress::Done, "written and verified")
        }
        Outcome::Written => PhaseStatus::new(Progress::InProgress, "written, not verified"),
        Outcome::RolledBack => PhaseStatus::new(Progress::NotStarted, "rolled back"),
        Outcome::Begun | Outcome::Unsettled(_) => {
            PhaseStatus::new(Progress::Attention, "writing was interrupted")
        }
        Outcome::Failed(_) => PhaseStatus::new(Progress::Attention, "writing failed"),
    }
}

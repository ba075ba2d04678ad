//! How far the adjustment of the controller is.

use tautline_session::{Outcome, Stage};

use crate::app::document::Document;
use crate::app::screen::{Progress, Standing};

/// What was written, and whether it was verified.
pub(super) fn whole(document: &Document) -> Standing {
    let session = document.session();
    let verified = |stage: Stage| session.verifications().iter().any(|run| run.stage == stage);
    let Some(last) = session.adjustments().last() else {
        return if verified(Stage::Before) {
            Standing::new(Progress::InProgress, "measured before the adjustment")
        } else {
            Standing::new(Progress::NotStarted, "nothing written yet")
        };
    };
    let after =
        |run: &tautline_session::Verification| run.stage == Stage::After && run.time >= last.time;
    match &last.outcome {
        Outcome::Written if document.fit().is_some() && !document.fit_is_current() => {
            Standing::new(Progress::OutOfDate, "data changed since it was written")
        }
        Outcome::Written if session.verifications().iter().any(after) => {
            Standing::new(Progress::Done, "written and verified")
        }
        Outcome::Written => Standing::new(Progress::InProgress, "written, not verified"),
        Outcome::RolledBack => Standing::new(Progress::NotStarted, "rolled back"),
        Outcome::Begun => Standing::new(Progress::Attention, "writing was interrupted"),
        Outcome::Failed(_) => Standing::new(Progress::Attention, "writing failed"),
    }
}

//! How far the measured poses are.

use crate::app::document::Document;
use crate::app::screen::{Progress, Standing};
use tautline_workflow::planning::missing;
use tautline_workflow::wording::count;

/// How many poses are measured and how many are still planned.
pub(super) fn whole(document: &Document) -> Standing {
    let session = document.session();
    let measured = session.measurements.len();
    match (measured, missing(session)) {
        (0, 0) => Standing::new(Progress::NotStarted, "no poses measured"),
        (0, missing) => Standing::new(
            Progress::NotStarted,
            format!("{} planned", count(missing, "pose")),
        ),
        (_, 0) => Standing::new(
            Progress::Done,
            format!("{} measured", count(measured, "pose")),
        ),
        (_, missing) => Standing::new(
            Progress::InProgress,
            format!("{} measured, {missing} to go", count(measured, "pose")),
        ),
    }
}

//! State of the measured poses.

use crate::model::OpenSession;
use crate::model::phase::{PhaseStatus, Progress};
use tautline_workflow::planning::poses_in_words;
use tautline_workflow::wording::count;

/// Number of poses measured and still planned.
pub(super) fn whole(open: &OpenSession) -> PhaseStatus {
    let session = open.session();
    let labels = || session.measurements.labels.iter().copied();
    match (labels().next(), open.missing()) {
        (None, []) => PhaseStatus::new(Progress::NotStarted, "no poses measured"),
        (None, missing) => {
            let poses = poses_in_words(missing.iter().copied());
            PhaseStatus::new(Progress::NotStarted, format!("{poses} planned"))
        }
        (Some(_), []) => {
            let poses = poses_in_words(labels());
            PhaseStatus::new(Progress::Done, format!("{poses} measured"))
        }
        (Some(_), missing) => {
            let is_pose = |label: &i64| *label != 0;
            let measured = labels().filter(is_pose).count();
            let planned = measured + missing.iter().copied().filter(is_pose).count();
            let poses = match session.settings.until.enabled {
                // The total number is not known beforehand.
                true => count(measured, "pose"),
                false => format!("{measured} of {planned} poses"),
            };
            PhaseStatus::new(Progress::InProgress, format!("{poses} measured"))
        }
    }
}

//! Start values of the poses.

use super::problem::{Globals, Poses, Problem};
use crate::geometry::Pose;

/// Start pose of every row: the commanded one, else the external instrument's, else home.
pub(super) fn start_poses(problem: &Problem<'_>, globals: &Globals, rows: &[usize]) -> Vec<Pose> {
    let data = &problem.dataset.measurements;
    let start = |row: &usize| {
        let tracked = data.tracked_position_at(*row).map(|position| Pose {
            position,
            orientation: globals.home.orientation,
        });
        if problem.poses == Poses::HeldAtTracker {
            return tracked.unwrap_or(globals.home);
        }
        let commanded = data.commanded.get(*row).copied().flatten();
        commanded.or(tracked).unwrap_or(globals.home)
    };
    rows.iter().map(start).collect()
}

//! Measuring until the goals are reached: decisions on the next pose, for window and commands.

mod document;
mod planner;
mod run;
mod wording;

use tautline_core::geometry::Pose;
use tautline_core::sequential::Goal;
use tautline_session::{PlannedPose, Session};

use crate::planning::SEED;

pub use document::{DecidedPose, GoalDocument, UntilDocument};
pub use planner::SequentialPlanner;
pub use run::{ChosenPose, SequentialRun, plan_home, planned_label};
pub use wording::{
    end_in_words, goals_in_words, obstacle_in_words, progress_in_words, reason_in_words,
    set_in_words,
};

/// Request to measure until goals are reached.
#[derive(Debug, Clone, PartialEq)]
pub struct UntilRequest {
    /// Goals, all of which have to be reached.
    pub goals: Vec<Goal>,
    /// Largest number of poses, the home pose not counted.
    pub at_most: usize,
    /// Seed of the poses from which the next one is chosen.
    pub seed: u64,
    /// Poses that may be measured, instead of those of the workspace.
    pub among: Option<Vec<Pose>>,
}

impl UntilRequest {
    /// The request of a session's settings.
    #[must_use]
    pub fn of_session(session: &Session) -> Self {
        let settings = &session.settings.until;
        Self {
            goals: settings.goals.clone(),
            at_most: settings.at_most,
            seed: SEED,
            among: settings.only_planned.then(|| planned_poses(session)),
        }
    }
}

/// The poses of a session's plan, without the home pose.
#[must_use]
pub fn planned_poses(session: &Session) -> Vec<Pose> {
    let planned = session.plan.iter().filter(|planned| planned.label != 0);
    planned.map(PlannedPose::pose).collect()
}

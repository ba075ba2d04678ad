//! A measuring run with a decision before each pose.

use tautline_core::geometry::Pose;
use tautline_core::robot::Robot;
use tautline_core::sequential::{Assessment, Decision, Goal, NextStep};
use tautline_session::{PlannedPose, Session};

use super::wording::{end_in_words, reason_in_words};
use super::{DecidedPose, SequentialPlanner, UntilDocument, UntilRequest};

/// A measuring run with a decision before each pose: its decisions and their results.
#[derive(Debug)]
pub struct SequentialRun {
    goals: Vec<Goal>,
    at_most: usize,
    planner: SequentialPlanner,
    /// Poses that could not be measured.
    excluded: Vec<Pose>,
    /// Label of the chosen pose that is neither measured nor left out yet.
    chosen: Option<i64>,
    last: Option<Decision>,
    poses: Vec<DecidedPose>,
}

/// The pose that a decision has chosen.
#[derive(Debug, Clone, PartialEq)]
pub struct ChosenPose {
    /// Label in the plan of the session.
    pub label: i64,
    /// Pose to command.
    pub pose: Pose,
    /// Reason for the choice, in words.
    pub reason: String,
}

impl ChosenPose {
    /// The entry of the session's log.
    #[must_use]
    pub fn log_text(&self) -> String {
        format!("Pose {} was chosen: it {}.", self.label, self.reason)
    }
}

impl SequentialRun {
    /// Starts the thread that decides; it calls `wake` after every decision.
    ///
    /// # Errors
    /// One sentence, if the session cannot be identified at all.
    pub fn start(
        session: &Session,
        request: UntilRequest,
        wake: impl Fn() + Send + 'static,
    ) -> Result<Self, String> {
        Ok(Self {
            goals: request.goals.clone(),
            at_most: request.at_most,
            planner: SequentialPlanner::start(session, request, wake)?,
            excluded: Vec::new(),
            chosen: None,
            last: None,
            poses: Vec::new(),
        })
    }

    /// Goals, all of which have to be reached.
    #[must_use]
    pub fn goals(&self) -> &[Goal] {
        &self.goals
    }

    /// Largest number of poses, the home pose not counted.
    #[must_use]
    pub fn at_most(&self) -> usize {
        self.at_most
    }

    /// Whether a decision is in progress.
    #[must_use]
    pub fn is_deciding(&self) -> bool {
        self.planner.is_deciding()
    }

    /// The poses that were chosen in this run, with the reasons.
    #[must_use]
    pub fn poses(&self) -> &[DecidedPose] {
        &self.poses
    }

    /// Assessment of the last decision; `None` while the first poses are measured.
    #[must_use]
    pub fn assessment(&self) -> Option<&Assessment> {
        self.last.as_ref()?.assessment.as_ref()
    }

    /// Reason why the run ended, in a few words; `None` unless a decision has ended it.
    #[must_use]
    pub fn end(&self) -> Option<&'static str> {
        end_in_words(&self.last.as_ref()?.step)
    }

    /// Goals, decisions and results as a document.
    #[must_use]
    pub fn document(&self, robot: &Robot) -> UntilDocument {
        UntilDocument::of(robot, &self.goals, self.last.as_ref(), self.poses.clone())
    }

    /// Asks for the next step after the poses of a session, unless a chosen pose is still to be measured.
    pub fn ask(&mut self, session: &Session) {
        if self.chosen.is_none() {
            self.planner.ask(session, &self.excluded);
        }
    }

    /// The pose of this label is measured and part of the session.
    pub fn measured(&mut self, label: i64, session: &Session) {
        self.chosen.take_if(|chosen| *chosen == label);
        self.ask(session);
    }

    /// The pose of this label was left out, so that another one is chosen.
    pub fn leave_out(&mut self, label: i64, session: &Session) {
        if self.chosen.take_if(|chosen| *chosen == label).is_some() {
            let planned = session.plan.iter().find(|planned| planned.label == label);
            self.excluded.extend(planned.map(PlannedPose::pose));
        }
        self.ask(session);
    }

    /// The decision, once it is made; it never waits.
    pub fn poll(&mut self) -> Option<Result<Decision, String>> {
        self.planner.poll()
    }

    /// Follows a decision: the chosen pose, which is in the plan of the session then; `None` if it ends the run.
    pub fn follow(&mut self, decision: Decision, session: &mut Session) -> Option<ChosenPose> {
        let step = decision.step.clone();
        self.last = Some(decision);
        let NextStep::Measure { pose, reason } = step else {
            return None;
        };
        let label = planned_label(session, &pose);
        let reason = reason_in_words(&session.robot, &reason);
        self.chosen = Some(label);
        self.poses.push(DecidedPose {
            pose: label,
            reason: reason.clone(),
        });
        Some(ChosenPose {
            label,
            pose,
            reason,
        })
    }
}

/// The label under which a pose is measured: that of the same pose of the plan that is not measured yet, else a new one, which is
/// added to the plan.
pub fn planned_label(session: &mut Session, pose: &Pose) -> i64 {
    let measured = &session.measurements.labels;
    let is_same = |planned: &&PlannedPose| {
        let is_open = planned.label != 0 && !measured.contains(&planned.label);
        is_open && planned.pose().difference(pose).amax() <= SAME
    };
    if let Some(planned) = session.plan.iter().find(is_same) {
        return planned.label;
    }
    let label = session.next_label();
    session.plan.push(PlannedPose::new(label, pose));
    label
}

/// Plans the home pose, to which all lengths refer, unless it is planned or measured.
pub fn plan_home(session: &mut Session) {
    let planned = session.plan.iter().map(|planned| planned.label);
    let mut known = planned.chain(session.measurements.labels.iter().copied());
    if known.any(|label| label == 0) {
        return;
    }
    if let Some(home) = session.robot.home {
        session.plan.insert(0, PlannedPose::new(0, &home.pose()));
    }
}

/// Poses closer than this are identical (m and rad).
const SAME: f64 = 1e-9;

//! Measuring until it is certain: decisions on the next pose in a thread of their own, for window and commands.

mod document;
mod wording;

use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};
use std::thread;

use tautline_core::effect::BoundEffect;
use tautline_core::estimation::Method;
use tautline_core::geometry::Pose;
use tautline_core::measurement::Measurements;
use tautline_core::planning::PlanOptions;
use tautline_core::robot::Robot;
use tautline_core::sequential::{Decision, Goal, SequentialDesign, SequentialOptions};
use tautline_session::{PlannedPose, Session};

use crate::identification::IdentificationRequest;

pub use document::{DecidedPose, GoalDocument, UntilDocument};
pub use wording::{obstacle_in_words, progress_in_words, reason_in_words, set_in_words};

/// What is asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct UntilRequest {
    /// When to stop: all of them.
    pub goals: Vec<Goal>,
    /// Largest number of poses, the home pose not counted.
    pub at_most: usize,
    /// Seed of the poses among which the next one is looked for.
    pub seed: u64,
    /// Poses that may be measured, instead of those of the workspace.
    pub among: Option<Vec<Pose>>,
}

/// Decides on the next pose while the robot goes on being watched.
///
/// The thread ends with this value, after the decision in progress.
#[derive(Debug)]
pub struct SequentialPlanner {
    questions: Sender<Question>,
    answers: Receiver<Result<Decision, String>>,
    is_deciding: bool,
}

/// The measured poses, and those that could not be measured.
type Question = (Measurements, Vec<Pose>);

/// The parts of a request that the thread owns.
struct Prepared {
    robot: Robot,
    effects: Vec<BoundEffect>,
    method: Method,
    request: UntilRequest,
}

impl Prepared {
    fn of(session: &Session, request: UntilRequest) -> Result<Self, String> {
        let own = IdentificationRequest::of_session(session).map_err(|error| error.to_string())?;
        Ok(Self {
            robot: own.dataset.robot.clone(),
            effects: own.effects,
            method: own.method,
            request,
        })
    }

    fn design(&self) -> Result<SequentialDesign<'_>, String> {
        let options = SequentialOptions {
            goals: &self.request.goals,
            at_most: self.request.at_most,
            among: self.request.among.as_deref(),
            plan: PlanOptions {
                effects: &self.effects,
                method: self.method,
                ..PlanOptions::new(1, self.request.seed)
            },
        };
        SequentialDesign::new(&self.robot, options).map_err(|error| error.to_string())
    }

    /// Answers questions until there are none any more.
    fn answer(&self, questions: &Receiver<Question>, answers: &Sender<Result<Decision, String>>) {
        let design = self.design();
        for (measured, excluded) in questions {
            let decided = match &design {
                Ok(design) => design
                    .next(&measured, &excluded)
                    .map_err(|error| error.to_string()),
                Err(error) => Err(error.clone()),
            };
            if answers.send(decided).is_err() {
                return;
            }
        }
    }
}

impl SequentialPlanner {
    /// Starts the thread for the robot of a session, which begins with what does not depend on readings.
    ///
    /// # Errors
    /// One sentence, if the session cannot be identified at all.
    pub fn start(session: &Session, request: UntilRequest) -> Result<Self, String> {
        let prepared = Prepared::of(session, request)?;
        let (questions, asked) = channel();
        let (decided, answers) = channel();
        thread::spawn(move || prepared.answer(&asked, &decided));
        Ok(Self {
            questions,
            answers,
            is_deciding: false,
        })
    }

    /// Asks for the next step after the measured poses of a session; `excluded` are poses that could not be measured.
    pub fn ask(&mut self, session: &Session, excluded: &[Pose]) {
        let measured = session.dataset().measurements;
        // If the thread has ended, `poll` says so.
        self.is_deciding = true;
        let _ = self.questions.send((measured, excluded.to_vec()));
    }

    /// Whether a decision is in progress.
    #[must_use]
    pub fn is_deciding(&self) -> bool {
        self.is_deciding
    }

    /// The decision, once it is made; it never waits.
    pub fn poll(&mut self) -> Option<Result<Decision, String>> {
        if !self.is_deciding {
            return None;
        }
        let answer = match self.answers.try_recv() {
            Ok(answer) => answer,
            Err(TryRecvError::Empty) => return None,
            Err(TryRecvError::Disconnected) => Err("the decision was broken off".to_owned()),
        };
        self.is_deciding = false;
        Some(answer)
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
    let planned = session.plan.iter().map(|planned| planned.label);
    let last = planned.chain(measured.iter().copied()).fold(0, i64::max);
    let label = last.saturating_add(1);
    session.plan.push(PlannedPose::new(label, pose));
    label
}

/// Poses closer than this are identical (m and rad).
const SAME: f64 = 1e-9;

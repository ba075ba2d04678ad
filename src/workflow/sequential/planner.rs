//! Decisions in a separate thread, so that the robot remains supervised.

use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};
use std::thread;

use tautline_core::effect::BoundEffect;
use tautline_core::estimation::Method;
use tautline_core::geometry::Pose;
use tautline_core::measurement::Measurements;
use tautline_core::planning::PlanOptions;
use tautline_core::robot::Robot;
use tautline_core::sequential::{Decision, SequentialDesign, SequentialOptions};
use tautline_session::Session;

use super::UntilRequest;
use crate::identification::IdentificationRequest;

/// Decides on the next pose while the robot remains supervised.
///
/// The thread ends with this value, after the decision in progress.
#[derive(Debug)]
pub struct SequentialPlanner {
    questions: Sender<Question>,
    answers: Receiver<Result<Decision, String>>,
    /// Number of unanswered questions; all answers but the last one are discarded.
    unanswered: usize,
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
    fn answer(
        &self,
        questions: &Receiver<Question>,
        answers: &Sender<Result<Decision, String>>,
        wake: impl Fn(),
    ) {
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
            wake();
        }
    }
}

impl SequentialPlanner {
    /// Starts the thread for the robot of a session, which begins with computations that do not depend on readings; it calls
    /// `wake` after every decision.
    ///
    /// # Errors
    /// One sentence, if the session cannot be identified at all.
    pub fn start(
        session: &Session,
        request: UntilRequest,
        wake: impl Fn() + Send + 'static,
    ) -> Result<Self, String> {
        let prepared = Prepared::of(session, request)?;
        let (questions, asked) = channel();
        let (decided, answers) = channel();
        thread::spawn(move || prepared.answer(&asked, &decided, wake));
        Ok(Self {
            questions,
            answers,
            unanswered: 0,
        })
    }

    /// Asks for the next step after the measured poses of a session; an earlier question is dropped. `excluded` are poses that
    /// could not be measured.
    pub fn ask(&mut self, session: &Session, excluded: &[Pose]) {
        let measured = session.dataset().measurements;
        // If the thread has ended, `poll` says so.
        self.unanswered += 1;
        let _ = self.questions.send((measured, excluded.to_vec()));
    }

    /// Whether a decision is in progress.
    #[must_use]
    pub fn is_deciding(&self) -> bool {
        self.unanswered > 0
    }

    /// The decision on the last question, once it is made; it never waits.
    pub fn poll(&mut self) -> Option<Result<Decision, String>> {
        while self.unanswered > 0 {
            let answer = match self.answers.try_recv() {
                Ok(answer) => answer,
                Err(TryRecvError::Empty) => return None,
                Err(TryRecvError::Disconnected) => {
                    self.unanswered = 0;
                    return Some(Err("the decision was broken off".to_owned()));
                }
            };
            self.unanswered -= 1;
            if self.unanswered == 0 {
                return Some(answer);
            }
        }
        None
    }
}

//! The history of one robot: jumps and drifts of its parts over many calibrations.
//!
//! **State.** The coordinates of all pulleys, the target plane and the parameters of effects are the state `x(t)` of the robot.
//! Session `j` at the time `t_j` has the information `L_j` on it, with the moment `L_j x_j`: that of its readings alone
//! ([`crate::comparison`]), with its home pose and home tensions eliminated. Each session has a datum of its own, so a common
//! motion of all parts is eliminated, too, in all sessions but the first. The deviations of parts within their tolerances are
//! the same in all sessions.
//!
//! **Model.** The state is constant but for the changes of a set `S`: a part jumps between two sessions, or drifts steadily,
//!
//! `x(t_j) = x_0 + sum_(k in S) f_k(t_j) u_k,   u_k ~ N(0, s_k^2),   f_k(t_j) = [j > after_k] or t_j`.
//!
//! With `M` the normal matrix of `x_0` and all `u_k` in units of their priors, and `h` its right-hand side, the log evidence of a
//! set is `1/2 h^T M^-1 h - 1/2 log det M`, up to a constant. Sizes `s_k` are summed over a grid. This is the smoother of a
//! linear Gaussian model with change points, in closed form; all sums over sessions are suffix sums, so that the cost is linear
//! in the number of sessions.
//!
//! **Posterior.** The probability of a change is the sum over the best set, the sets with one change more, with one less, and with
//! one change replaced by another.

mod forecast;
mod health;
mod search;
mod state;
#[cfg(test)]
mod tests;
mod timeline;

use nalgebra::{DMatrix, DVector};

use crate::comparison::{ComparisonError, Identified};
use search::Search;
use state::{Followed, State, session_information};
use timeline::Timeline;

pub use forecast::{Forecast, NoPositionError, OUT_OF_TOLERANCE, Tolerance, forecast};
pub use health::{HealthCheck, check};

/// Probability from which a change or a drift is stated as a fact.
pub const CERTAIN: f64 = 0.95;
/// Smallest probability of a change that is listed.
const LISTED: f64 = 0.05;

/// One calibration of the robot.
#[derive(Debug, Clone, Copy)]
pub struct DatedRun<'a> {
    /// Problem and solution.
    pub run: Identified<'a>,
    /// Day of the measurement, counted from any origin.
    pub days: f64,
    /// Whether an event between the previous run and this one makes changes likely: an adjustment, a repair, a crash.
    pub follows_event: bool,
}

/// A part of the robot whose state is followed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum RobotPart {
    /// The pulley of a cable, by its index.
    Pulley(usize),
    /// The laser's target plane.
    TargetPlane,
    /// A parameter of an effect.
    Effect {
        /// Effect of the catalogue.
        effect: String,
        /// Names of its cables; empty for all.
        targets: Vec<String>,
        /// Name of the parameter.
        parameter: String,
        /// SI unit.
        unit: &'static str,
    },
}

/// The state of a part in one session, with all sessions taken into account.
#[derive(Debug, Clone, PartialEq)]
pub struct SmoothedState {
    /// Coordinates that are estimated: of a pulley those that any session estimates, in the order of the axes (m), of other parts
    /// one number (SI unit).
    pub value: DVector<f64>,
    /// Their covariance.
    pub covariance: DMatrix<f64>,
}

/// A jump of a part between two sessions.
#[derive(Debug, Clone, PartialEq)]
pub struct Jump {
    /// Index of the part.
    pub part: usize,
    /// Index of the last session before it and of the first session after it. They are adjacent, unless the sessions between
    /// do not tell when it happened.
    pub between: [usize; 2],
    /// Posterior probability.
    pub probability: f64,
    /// Size in the coordinates of the part.
    pub size: DVector<f64>,
    /// Covariance of the size.
    pub covariance: DMatrix<f64>,
}

/// A steady drift of a part.
#[derive(Debug, Clone, PartialEq)]
pub struct Drift {
    /// Index of the part.
    pub part: usize,
    /// Posterior probability.
    pub probability: f64,
    /// Rate in the coordinates of the part, per day.
    pub rate: DVector<f64>,
    /// Covariance of the rate.
    pub covariance: DMatrix<f64>,
    /// Whether the data of the sessions make the drift probable. A drift that they can neither show nor rule out remains
    /// possible.
    pub is_evident: bool,
}

/// History of a robot.
#[derive(Debug, Clone, PartialEq)]
pub struct History {
    /// Days of the sessions after the first one.
    pub days: Vec<f64>,
    /// The parts that are followed.
    pub parts: Vec<RobotPart>,
    /// Axes of the coordinates of each part that are estimated; empty for parts other than pulleys.
    pub axes: Vec<Vec<usize>>,
    /// State of each part in each session, `states[part][session]`.
    pub states: Vec<Vec<SmoothedState>>,
    /// Information of all sessions on a jump of each part after each session but the last, given the other changes,
    /// `information[part][session]`: a jump `u` has the noncentrality `u^T I u`.
    pub information: Vec<Vec<DMatrix<f64>>>,
    /// Jumps with their probabilities, the earliest first.
    pub jumps: Vec<Jump>,
    /// A drift of each part with its probability, evident or not.
    pub drifts: Vec<Drift>,
    /// Posterior probability that nothing changed.
    pub unchanged: f64,
}

impl History {
    /// The drifts that the sessions make probable.
    pub fn evident_drifts(&self) -> impl Iterator<Item = &Drift> {
        self.drifts.iter().filter(|drift| drift.is_evident)
    }
}

/// Errors of [`smooth`].
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum HistoryError {
    /// One session has no history.
    #[error("the number of sessions is {0}, expected at least 2")]
    TooFew(usize),
    /// The sessions are not in the order of time.
    #[error("session {0} is earlier than the one before it")]
    Disordered(usize),
    /// The sessions are of different robots.
    #[error("session {session} is of another robot: {error}")]
    OtherRobot {
        /// Number of the session, from 1.
        session: usize,
        /// Difference from the robot of the first session.
        error: ComparisonError,
    },
    /// The data of a session do not determine the robot.
    #[error("the data of session {0} do not determine the whole geometry")]
    Undetermined(usize),
}

/// Smooths the state of a robot over its sessions, which are in the order of time, and finds the changes.
///
/// # Errors
/// If there are fewer than two sessions, or the data of one do not determine the robot, or one is of another robot.
pub fn smooth(runs: &[DatedRun<'_>]) -> Result<History, HistoryError> {
    if runs.len() < 2 {
        return Err(HistoryError::TooFew(runs.len()));
    }
    if let Some(k) = (1..runs.len()).find(|k| runs[*k].days < runs[k - 1].days) {
        return Err(HistoryError::Disordered(k + 1));
    }
    smoothed(runs, Followed::Model)
}

fn smoothed(runs: &[DatedRun<'_>], followed: Followed) -> Result<History, HistoryError> {
    let state = State::of(runs, followed)?;
    let mut sessions = Vec::with_capacity(runs.len());
    for (index, run) in runs.iter().enumerate() {
        let own = session_information(&state, &run.run, index);
        sessions.push(own.ok_or(HistoryError::Undetermined(index + 1))?);
    }
    let days: Vec<f64> = runs.iter().map(|run| run.days - runs[0].days).collect();
    let timeline = Timeline::new(&state, &days, &sessions);
    let events: Vec<bool> = runs.iter().map(|run| run.follows_event).collect();
    let mut search =
        Search::new(&state, &timeline, &events).ok_or(HistoryError::Undetermined(1))?;
    search.run();
    Ok(search.history())
}

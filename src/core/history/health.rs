//! A health check: few poses against a calibration.
//!
//! The baseline and the check are two sessions of a history. Besides pulleys, target plane and the effects of the model, every
//! deviation of a part within its tolerance may have changed, so that a drum that now winds differently is not taken for a
//! pulley that moved. The baseline says how uncertain everything is that the few poses do not determine.

use nalgebra::{DMatrix, DVector};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::search::{evidence, jump_probability};
use super::state::{Followed, TYPICAL_MOVE_M};
use super::{CERTAIN, DatedRun, History, HistoryError, RobotPart, smoothed};
use crate::statistics::{covariance_root, logit};

/// Number of random moves from which a probability of detection is computed, and their seed.
const MOVES: usize = 400;
const SEED: u64 = 36;
/// Range of moves that are looked at for the smallest detectable one (m), and its relative exactness.
const MOVES_M: [f64; 2] = [1e-6, 1.0];
const EXACTNESS: f64 = 0.02;

/// Result of a check of the robot: changes since the baseline.
#[derive(Debug, Clone, PartialEq)]
pub struct HealthCheck {
    /// Both sessions with the changes between them; those of one part are the same as in any history.
    pub history: History,
    /// Prior log odds that one part has changed.
    log_odds: f64,
}

/// Compares a check with the calibration before it.
///
/// # Errors
/// If the robots are different, or the data do not determine the robot.
pub fn check(baseline: &DatedRun<'_>, check: &DatedRun<'_>) -> Result<HealthCheck, HistoryError> {
    let history = smoothed(&[*baseline, *check], Followed::ModelAndDeviations)?;
    let days = check.days - baseline.days;
    let prior = jump_probability(days, check.follows_event, history.parts.len());
    Ok(HealthCheck {
        log_odds: logit(prior),
        history,
    })
}

impl HealthCheck {
    /// Probability that the check finds that a pulley moved so far (m) in a random direction: that a change is certain then.
    /// `None` for a part that is no pulley or whose coordinates are all known.
    #[must_use]
    pub fn detection(&self, part: usize, move_m: f64) -> Option<f64> {
        Some(self.moves(part)?.detection(move_m))
    }

    /// The smallest move of a pulley (m) that the check finds with this probability; `None` if it finds none.
    #[must_use]
    pub fn detectable_m(&self, part: usize, probability: f64) -> Option<f64> {
        let moves = self.moves(part)?;
        let [mut low, mut high] = MOVES_M;
        if moves.detection(high) < probability {
            return None;
        }
        while high / low > 1.0 + EXACTNESS {
            let middle = (low * high).sqrt();
            match moves.detection(middle) < probability {
                true => low = middle,
                false => high = middle,
            }
        }
        Some(high)
    }

    fn moves(&self, part: usize) -> Option<Moves<'_>> {
        let information = self.history.information[part].first()?;
        let is_pulley = matches!(self.history.parts[part], RobotPart::Pulley(_));
        let count = information.nrows();
        if !is_pulley || count == 0 {
            return None;
        }
        let mut rng = ChaCha8Rng::seed_from_u64(SEED);
        let mut normal = || DMatrix::from_fn(count, MOVES, |_, _| StandardNormal.sample(&mut rng));
        let (mut directions, noise) = (normal(), normal());
        for mut direction in directions.column_iter_mut() {
            direction.normalize_mut();
        }
        // The information may be singular where the poses do not see a direction.
        let root = covariance_root(information);
        Some(Moves {
            information,
            scores: information * directions,
            noise: root * noise,
            log_odds: self.log_odds,
        })
    }
}

/// Random moves of one pulley, as the check would see them.
struct Moves<'a> {
    information: &'a DMatrix<f64>,
    /// Expected scores of moves of unit length.
    scores: DMatrix<f64>,
    noise: DMatrix<f64>,
    log_odds: f64,
}

impl Moves<'_> {
    fn detection(&self, move_m: f64) -> f64 {
        let certain = logit(CERTAIN);
        let found = self.scores.column_iter().zip(self.noise.column_iter());
        let found = found.filter(|(score, noise)| {
            let score: DVector<f64> = score * move_m + noise;
            let (evidence, _) = evidence(&score, self.information, TYPICAL_MOVE_M);
            self.log_odds + evidence >= certain
        });
        found.count() as f64 / MOVES as f64
    }
}

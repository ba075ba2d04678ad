//! When the robot should be calibrated again.

use nalgebra::{DMatrix, DVector};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::search::{DAYS_PER_YEAR, JUMPS_PER_YEAR, SCALES};
use super::state::TYPICAL_MOVE_M;
use super::{History, Part};

/// Probability of being out of tolerance at which a new calibration is due.
pub const OUT_OF_TOLERANCE: f64 = 0.05;
/// The farthest day that is looked at.
const FARTHEST_DAYS: f64 = 10.0 * DAYS_PER_YEAR;
/// Number of random points for the probability that a vector is longer than the tolerance, and their seed.
const POINTS: usize = 4096;
const SEED: u64 = 36;

/// What is expected after the last session.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Forecast {
    /// Largest tolerable displacement of a pulley from its value in the last session (m).
    pub tolerance_m: f64,
    /// Probability that a pulley is out of tolerance already, because its value is uncertain.
    pub at_once: f64,
    /// Days after the last session at which the probability that a pulley is out of tolerance reaches 5 %; `None` if it does
    /// not within ten years.
    pub due_days: Option<f64>,
}

/// Forecasts when a pulley is out of tolerance with a probability of 5 %: by drifts, found or merely possible, with the uncertainty of
/// their rates and of the values of the last session, and by jumps as often as before.
///
/// Jumps have the rate `(1 + n) / (1 / r + T)` with the `n` jumps of `T` years and `r` of them expected per year: the posterior mean
/// for a Poisson process with an exponential prior. Their sizes have the prior of the search.
#[must_use]
pub fn forecast(history: &History, tolerance_m: f64) -> Forecast {
    let is_pulley = |part: usize| matches!(history.parts[part], Part::Pulley(_));
    let jumps = history.jumps.iter().filter(|jump| is_pulley(jump.part));
    let found: f64 = jumps.map(|jump| jump.probability).sum();
    let years = history.days.last().copied().unwrap_or(0.0) / DAYS_PER_YEAR;
    let per_day = (1.0 + found) / (1.0 / JUMPS_PER_YEAR + years) / DAYS_PER_YEAR;
    let points = Points::new();
    let beyond = |scale: &f64| {
        let sd = scale * TYPICAL_MOVE_M;
        points.share_beyond(
            tolerance_m,
            &DVector::zeros(3),
            &DMatrix::from_diagonal_element(3, 3, sd * sd),
        )
    };
    let per_day = per_day * SCALES.iter().map(beyond).sum::<f64>() / SCALES.len() as f64;
    let probability = |days: f64| {
        let mut within = (-per_day * days).exp();
        for (part, states) in history.states.iter().enumerate() {
            let Some(last) = states
                .last()
                .filter(|last| is_pulley(part) && !last.value.is_empty())
            else {
                continue;
            };
            let still = points.share_beyond(
                tolerance_m,
                &DVector::zeros(last.value.len()),
                &last.covariance,
            );
            let drift = history.drifts.iter().find(|drift| drift.part == part);
            let out = drift.map_or(still, |drift| {
                let covariance = &last.covariance + &drift.covariance * (days * days);
                let moving = points.share_beyond(tolerance_m, &(&drift.rate * days), &covariance);
                drift.probability * moving + (1.0 - drift.probability) * still
            });
            within *= 1.0 - out;
        }
        1.0 - within
    };
    let at_once = probability(0.0);
    let due_days = (probability(FARTHEST_DAYS) >= OUT_OF_TOLERANCE).then(|| {
        let (mut low, mut high) = (0.0, FARTHEST_DAYS);
        while high - low > 0.1 {
            let middle = 0.5 * (low + high);
            match probability(middle) < OUT_OF_TOLERANCE {
                true => low = middle,
                false => high = middle,
            }
        }
        low
    });
    Forecast {
        tolerance_m,
        at_once,
        due_days,
    }
}

/// Random points of a standard normal distribution in space, the same for all questions.
struct Points(DMatrix<f64>);

impl Points {
    fn new() -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(SEED);
        Self(DMatrix::from_fn(3, POINTS, |_, _| {
            StandardNormal.sample(&mut rng)
        }))
    }

    /// Probability that a normal vector of up to three numbers is longer than `length`.
    fn share_beyond(&self, length: f64, mean: &DVector<f64>, covariance: &DMatrix<f64>) -> f64 {
        let count = mean.len();
        let Some(factor) = covariance.clone().cholesky() else {
            return f64::from(u8::from(mean.norm() > length));
        };
        let vectors = factor.l() * self.0.rows(0, count);
        let is_beyond = |v: &nalgebra::DVectorView<'_, f64>| (v + mean).norm() > length;
        let beyond = vectors.column_iter().filter(is_beyond).count();
        beyond as f64 / POINTS as f64
    }
}

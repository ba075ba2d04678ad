//! Forecast of the date at which the robot should be calibrated again.
//!
//! A controller that keeps the values `p` of the last session has at the day `t` after it the error
//!
//! `e(t) = A (dp + d t + sum of the jumps until t)`,
//!
//! with the error `dp` of the values, the drift `d` of the pulleys and their jumps. For a tolerance of pulleys, `A` is the identity, and
//! the longest displacement of a pulley counts. For a tolerance of the position of the platform, `A^T A` are the weights by which
//! errors of entry points and home pose give the mean square position error over a volume
//! ([`planning`](crate::planning), the criterion of a plan for accuracy), and its root counts.
//!
//! The probability of being out of tolerance is that of simulated futures. A drift is present with its posterior probability. Jumps
//! have a rate with the posterior `Gamma(1 + n, 1 / r + T)`, for `n` jumps in `T` years and `r` of them expected per year: that of a
//! Poisson process with an exponential prior. Their sizes have the prior of the search. The interval of the date shows its
//! dependence on the uncertain rates of drifts and jumps: it is that of the dates for rates drawn from their posterior.

use nalgebra::{DMatrix, DVector, DVectorView};
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Exp1, Gamma, StandardNormal};

use super::search::{DAYS_PER_YEAR, JUMPS_PER_YEAR, SCALES};
use super::state::TYPICAL_MOVE_M;
use super::{History, RobotPart};
use crate::comparison::Identified;
use crate::estimation::{Parameter, ParameterId};
use crate::planning::{Volume, position_weights};
use crate::simulation::Workspace;
use crate::statistics::covariance_root;

/// Probability of being out of tolerance at which a new calibration is due.
pub const OUT_OF_TOLERANCE: f64 = 0.05;
/// Horizon of the forecast (days).
const FARTHEST_DAYS: f64 = 10.0 * DAYS_PER_YEAR;
/// Width of the interval in which a date is looked for (days).
const EXACT_DAYS: f64 = 0.1;
/// Number of rates of drifts and jumps that are drawn, and of futures for each: the standard deviation of the probability of 5 % is
/// 0.2 % then.
const RATES: usize = 100;
const FUTURES: usize = 200;
/// Two-sided probability of the interval.
const INTERVAL: f64 = 0.95;
/// Seed of the futures, the same for all questions.
const SEED: u64 = 36;

/// Quantity with a tolerance.
#[derive(Debug, Clone, Copy)]
pub enum Tolerance<'a> {
    /// Displacement of a pulley from its value in the last session (m).
    Pulley(f64),
    /// Root mean square position error of the platform over a volume (m).
    Position {
        /// The tolerance (m).
        limit_m: f64,
        /// The volume; `None` for the workspace of the robot.
        volume: Option<Volume>,
        /// The last session, whose entry points and home pose the controller has.
        last: Identified<'a>,
    },
}

/// Forecast of the time until the robot is out of tolerance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Forecast {
    /// Probability of being out of tolerance already, because the values of the last session are uncertain.
    pub at_once: f64,
    /// Largest error of the values of the last session that is exceeded with the probability at which a calibration is due (m):
    /// a smaller tolerance is left at once.
    pub known_m: f64,
    /// Days after the last session at which the probability of being out of tolerance reaches 5 %; `None` if it does not within ten
    /// years.
    pub due_days: Option<f64>,
    /// 95 % interval of `due_days`, from the uncertain rates of drifts and jumps. `None` for an end beyond ten years.
    pub interval_days: [Option<f64>; 2],
}

/// The position error of the platform cannot be predicted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error(
    "the position error in the volume cannot be predicted: the robot has no home pose, or no cable path reaches the volume"
)]
pub struct NoPositionError;

/// Forecasts when the probability of being out of tolerance reaches 5 %.
///
/// # Errors
/// If the position error of the platform cannot be predicted.
pub fn forecast(history: &History, tolerance: Tolerance<'_>) -> Result<Forecast, NoPositionError> {
    let error = match tolerance {
        Tolerance::Pulley(limit_m) => ErrorOfValues::of_pulleys(history, limit_m),
        Tolerance::Position {
            limit_m,
            volume,
            last,
        } => {
            ErrorOfValues::of_position(history, (limit_m, volume), &last).ok_or(NoPositionError)?
        }
    };
    let mut rng = ChaCha8Rng::seed_from_u64(SEED);
    let years = history.days.last().copied().unwrap_or(0.0) / DAYS_PER_YEAR;
    let found = jumps_of_pulleys(history);
    let rates: Vec<Rates> = (0..RATES)
        .map(|_| Rates::draw(history, &error, (found, years), &mut rng))
        .collect();
    let share = |of: &[Rates], days: f64| {
        let out: usize = of
            .iter()
            .map(|rates| rates.out_of_tolerance(&error, days))
            .sum();
        out as f64 / (of.len() * FUTURES) as f64
    };
    let mut each: Vec<f64> = rates
        .iter()
        .map(|one| due(|days| share(std::slice::from_ref(one), days)).unwrap_or(f64::INFINITY))
        .collect();
    each.sort_by(f64::total_cmp);
    let rank = |p: f64| each[((p * RATES as f64) as usize).min(RATES - 1)];
    let ends = [0.5 - 0.5 * INTERVAL, 0.5 + 0.5 * INTERVAL].map(rank);
    let columns = rates.iter().flat_map(|rates| rates.errors.column_iter());
    let mut known: Vec<f64> = columns
        .map(|values| error.largest_m(values.as_slice()))
        .collect();
    known.sort_by(f64::total_cmp);
    let place = ((1.0 - OUT_OF_TOLERANCE) * known.len() as f64) as usize;
    Ok(Forecast {
        at_once: share(&rates, 0.0),
        known_m: known.get(place).copied().unwrap_or(0.0),
        due_days: due(|days| share(&rates, days)),
        interval_days: ends.map(|days| days.is_finite().then_some(days)),
    })
}

/// The day at which a probability reaches 5 %.
fn due(probability: impl Fn(f64) -> f64) -> Option<f64> {
    if probability(FARTHEST_DAYS) < OUT_OF_TOLERANCE {
        return None;
    }
    let (mut low, mut high) = (0.0, FARTHEST_DAYS);
    while high - low > EXACT_DAYS {
        let middle = 0.5 * (low + high);
        match probability(middle) < OUT_OF_TOLERANCE {
            true => low = middle,
            false => high = middle,
        }
    }
    Some(low)
}

/// Expected number of jumps of pulleys that were found.
fn jumps_of_pulleys(history: &History) -> f64 {
    let of_pulley = |part: usize| matches!(history.parts[part], RobotPart::Pulley(_));
    let jumps = history.jumps.iter().filter(|jump| of_pulley(jump.part));
    jumps.map(|jump| jump.probability).sum()
}

/// Linear map from errors of the values and displacements of the pulleys to the error that has a tolerance.
struct ErrorOfValues {
    limit_m: f64,
    /// Number of adjacent coordinates of which the length counts.
    group: usize,
    /// Number of coordinates.
    count: usize,
    /// `A R` with `R R^T` the covariance of the errors of the values.
    of_values: DMatrix<f64>,
    /// Each pulley that can move, by its part, with the columns of `A` that belong to its coordinates.
    pulleys: Vec<(usize, DMatrix<f64>)>,
}

impl ErrorOfValues {
    fn of_pulleys(history: &History, limit_m: f64) -> Self {
        let movable: Vec<usize> = movable(history).collect();
        let count = 3 * movable.len();
        let mut of_values = DMatrix::zeros(count, count);
        let mut pulleys = Vec::new();
        for (place, part) in movable.into_iter().enumerate() {
            let axes = &history.axes[part];
            let mut columns = DMatrix::zeros(count, axes.len());
            for (k, axis) in axes.iter().enumerate() {
                columns[(3 * place + axis, k)] = 1.0;
            }
            if let Some(last) = history.states[part].last() {
                let own = &columns * covariance_root(&last.covariance);
                of_values.columns_mut(3 * place, axes.len()).copy_from(&own);
            }
            pulleys.push((part, columns));
        }
        Self {
            limit_m,
            group: 3,
            count,
            of_values,
            pulleys,
        }
    }

    /// `None` if the position error cannot be predicted.
    fn of_position(
        history: &History,
        (limit_m, volume): (f64, Option<Volume>),
        last: &Identified<'_>,
    ) -> Option<Self> {
        let own = &last.solution.parameters;
        let counts =
            |id: &ParameterId| matches!(id, ParameterId::EntryPoint { .. } | ParameterId::Home(_));
        let estimated: Vec<usize> = (0..own.len()).filter(|k| counts(&own[*k].id)).collect();
        let mut parameters: Vec<Parameter> = estimated.iter().map(|k| own[*k].clone()).collect();
        // A pulley that only other sessions estimated may move, too.
        for part in movable(history) {
            let RobotPart::Pulley(cable) = history.parts[part] else {
                continue;
            };
            for axis in history.axes[part].iter().copied() {
                let id = ParameterId::EntryPoint { cable, axis };
                if parameters.iter().all(|known| known.id != id) {
                    parameters.push(Parameter {
                        id,
                        name: String::new(),
                        unit: "m",
                        prior_sd: None,
                    });
                }
            }
        }
        let robot = &last.problem.dataset.robot;
        let workspace = Workspace::of(robot);
        let within = volume.map_or(workspace, |volume| {
            workspace.of_volume(volume.centre_m(), volume.half_extent_m())
        });
        let weights = position_weights(robot, &within, &parameters)?;
        let factor = covariance_root(&weights).transpose();
        let covariance = last.solution.covariance.as_ref()?;
        let covariance = covariance
            .select_rows(&estimated)
            .select_columns(&estimated);
        let of_values = factor.columns(0, estimated.len()) * covariance_root(&covariance);
        let columns = |part: usize| {
            let RobotPart::Pulley(cable) = history.parts[part] else {
                return Vec::new();
            };
            let axes = history.axes[part].iter().copied();
            let place = |axis| {
                let id = ParameterId::EntryPoint { cable, axis };
                parameters.iter().position(|known| known.id == id)
            };
            axes.filter_map(place).collect()
        };
        Some(Self {
            limit_m,
            group: factor.nrows(),
            count: factor.nrows(),
            of_values,
            pulleys: movable(history)
                .map(|part| (part, factor.select_columns(&columns(part))))
                .collect(),
        })
    }

    /// The largest of the lengths that count.
    fn largest_m(&self, error: &[f64]) -> f64 {
        let groups = error.chunks(self.group.max(1));
        let squares = groups.map(|group| group.iter().map(|e| e * e).sum::<f64>());
        squares.fold(0.0, f64::max).sqrt()
    }
}

/// Indices of the pulleys of which any coordinate is followed.
fn movable(history: &History) -> impl Iterator<Item = usize> {
    let is_movable = |part: &usize| {
        matches!(history.parts[*part], RobotPart::Pulley(_)) && !history.axes[*part].is_empty()
    };
    (0..history.parts.len()).filter(is_movable)
}

fn normal(count: usize, rng: &mut impl Rng) -> DVector<f64> {
    DVector::from_fn(count, |_, _| StandardNormal.sample(rng))
}

struct FutureJump {
    days: f64,
    /// Change of the error by the jump.
    by: DVector<f64>,
}

/// Drift and possible future jumps for one draw of their rates.
struct Rates {
    /// Change of the error per day by drifts.
    drift: DVector<f64>,
    /// Errors of the values, one column for each future.
    errors: DMatrix<f64>,
    /// Jumps of each future, the earliest first.
    jumps: Vec<Vec<FutureJump>>,
}

impl Rates {
    /// `found` jumps in some years determine the rate of jumps.
    fn draw(
        history: &History,
        error: &ErrorOfValues,
        (found, years): (f64, f64),
        rng: &mut ChaCha8Rng,
    ) -> Self {
        let mut drift = DVector::zeros(error.count);
        for (part, columns) in &error.pulleys {
            let Some(own) = history.drifts.iter().find(|own| own.part == *part) else {
                continue;
            };
            let rate = &own.rate + covariance_root(&own.covariance) * normal(own.rate.len(), rng);
            if rng.random_bool(own.probability.clamp(0.0, 1.0)) {
                drift += columns * rate;
            }
        }
        let per_year = Gamma::new(1.0 + found, (1.0 / JUMPS_PER_YEAR + years).recip());
        let per_day = per_year.map_or(0.0, |rate| rate.sample(rng)) / DAYS_PER_YEAR;
        let inputs = error.of_values.ncols();
        let standard = DMatrix::from_fn(inputs, FUTURES, |_, _| StandardNormal.sample(rng));
        Self {
            drift,
            errors: &error.of_values * standard,
            jumps: (0..FUTURES)
                .map(|_| future_jumps(error, per_day, rng))
                .collect(),
        }
    }

    /// Number of futures that are out of tolerance at a day.
    fn out_of_tolerance(&self, error: &ErrorOfValues, days: f64) -> usize {
        let mut sum = vec![0.0; error.count];
        let is_out = |(values, jumps): &(DVectorView<'_, f64>, &Vec<FutureJump>)| {
            for ((sum, value), drift) in sum.iter_mut().zip(values.iter()).zip(&self.drift) {
                *sum = value + drift * days;
            }
            for jump in jumps.iter().take_while(|jump| jump.days <= days) {
                for (sum, by) in sum.iter_mut().zip(&jump.by) {
                    *sum += by;
                }
            }
            error.largest_m(&sum) > error.limit_m
        };
        self.errors
            .column_iter()
            .zip(&self.jumps)
            .filter(is_out)
            .count()
    }
}

/// Jumps of random pulleys by random sizes.
fn future_jumps(error: &ErrorOfValues, per_day: f64, rng: &mut ChaCha8Rng) -> Vec<FutureJump> {
    let mut jumps = Vec::new();
    let mut days = 0.0;
    if error.pulleys.is_empty() {
        return jumps;
    }
    loop {
        let waiting: f64 = Exp1.sample(rng);
        days += waiting / per_day;
        if days > FARTHEST_DAYS {
            return jumps;
        }
        let (_, columns) = &error.pulleys[rng.random_range(0..error.pulleys.len())];
        let sd_m = SCALES[rng.random_range(0..SCALES.len())] * TYPICAL_MOVE_M;
        let by = columns * normal(columns.ncols(), rng) * sd_m;
        jumps.push(FutureJump { days, by });
    }
}

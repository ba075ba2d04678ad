//! Detection of standstills.
//!
//! The speed of a channel at a row is the difference of its means over the two halves of a window around the row, divided
//! by half the window: noise averages out, and a single outlier does not count as motion. A row is at rest if every channel
//! that moves with the platform is slower than its limit.

use std::collections::VecDeque;
use std::ops::Range;

use tautline_channels::Values;
use tautline_core::robot::Robot;

use super::clock::usual_step;
use crate::median::median;
use crate::recipe::{Mapping, Quantity, QuantityKind as Kind, Rest};

/// Allowance for noise on top of the speed limit (standard deviations).
const NOISE: f64 = 4.0;
/// Steps longer than this multiple of the usual step end a standstill.
const GAP: f64 = 5.0;
/// Maximum number of second differences from which the noise is estimated.
const MOST_DIFFERENCES: usize = 100_000;

/// Speed limits of a standstill, for each kind of quantity.
pub(super) struct Limits {
    revolutions: Vec<f64>,
    speed: f64,
    turn: f64,
}

impl Limits {
    pub fn of(robot: &Robot, rest: &Rest) -> Self {
        let revolutions = robot
            .cables
            .iter()
            .map(|cable| rest.speed_m_s / cable.winch.cable_per_revolution_m());
        Self {
            revolutions: revolutions.collect(),
            speed: rest.speed_m_s,
            turn: rest.turn_rad_s,
        }
    }

    fn limit(&self, quantity: Quantity) -> f64 {
        match quantity.kind {
            Kind::Revolutions => self
                .revolutions
                .get(quantity.index)
                .copied()
                .unwrap_or(f64::INFINITY),
            Kind::Swivel | Kind::Inclination | Kind::CommandedAngle | Kind::TrackedAngle => {
                self.turn
            }
            Kind::Commanded | Kind::Tracked if quantity.index > 2 => self.turn / 2.0,
            _ => self.speed,
        }
    }
}

/// Ranges of rows of the series `main` at rest, without the settling time.
pub(super) fn find(
    mapping: &Mapping<'_>,
    main: usize,
    time_s: &[f64],
    rest: &Rest,
    limits: &Limits,
) -> Vec<Range<usize>> {
    let rows = time_s.len();
    let mut still = vec![true; rows];
    let Some(usual) = usual_step(time_s) else {
        return Vec::new();
    };
    let half = ((rest.minimum_s / 4.0 / usual).round() as usize).max(1);
    let moving = mapping
        .quantities
        .iter()
        .filter(|(quantity, mapped)| mapped.series == main && quantity.moves());
    let mut any = false;
    for (quantity, mapped) in moving {
        any = true;
        let values = &mapping.series[main].channels[mapped.channel].values;
        let limit = limits.limit(*quantity) / mapped.factor.abs();
        mark_motion(values, half, half as f64 * usual, limit, &mut still);
    }
    if !any {
        return Vec::new();
    }
    // A row after a jump of the clock or a gap begins a new standstill.
    let breaks = |row: usize| {
        let step = time_s[row] - time_s[row - 1];
        !(0.0..=GAP * usual).contains(&step)
    };
    // A row at rest is preceded by half a window at rest, which counts as settling time.
    let settle = ((rest.settle_s / usual).round() as usize).saturating_sub(half);
    let window_s = 2.0 * half as f64 * usual;
    let mut found = Vec::new();
    let mut start = None;
    for row in 0..=rows {
        let goes_on = row < rows && still[row] && !(row > 0 && start.is_some() && breaks(row));
        match (goes_on, start) {
            (true, None) => start = Some(row),
            (false, Some(from)) => {
                let lasted_s = time_s[row - 1] - time_s[from] + window_s;
                let (from, to) = (from + settle, row.saturating_sub(settle));
                if to > from && lasted_s >= rest.minimum_s {
                    found.push(from..to);
                }
                // The row after a break may be at rest itself.
                start = (row < rows && still[row]).then_some(row);
            }
            _ => {}
        }
    }
    found
}

/// Clears the rows at which a channel moves faster than `limit`.
fn mark_motion(values: &Values, half: usize, half_s: f64, limit: f64, still: &mut [bool]) {
    let sd = noise(values);
    let allowed = limit + NOISE * sd * (2.0 / half as f64).sqrt() / half_s;
    let mut sums = Sums::of(values);
    let rows = values.len();
    for (row, still) in still.iter_mut().enumerate() {
        // Near the ends the window is shorter, and the halves with it.
        let reach = half.min(row.max(1)).min((rows - row).max(1));
        let (from, to) = (row.saturating_sub(reach), (row + reach).min(rows));
        sums.keep(row.saturating_sub(half), to);
        if let (Some(before), Some(after)) = (sums.mean(from, row), sums.mean(row, to)) {
            let widened = (half as f64 / reach as f64).sqrt();
            let speed = (after - before).abs() / (half_s * reach as f64 / half as f64);
            let allowed = limit + (allowed - limit) * widened.powi(3);
            *still &= speed <= allowed;
        }
    }
}

/// Running sums and counts of the values before each row, relative to the first value, for a moving window.
struct Sums<'a> {
    values: Box<dyn Iterator<Item = f64> + 'a>,
    reference: f64,
    /// Row of the first stored sum.
    first: usize,
    kept: VecDeque<(f64, usize)>,
}

impl<'a> Sums<'a> {
    fn of(values: &'a Values) -> Self {
        Self {
            reference: values.iter().find(|value| !value.is_nan()).unwrap_or(0.0),
            values: Box::new(values.iter()),
            first: 0,
            kept: VecDeque::from([(0.0, 0)]),
        }
    }

    /// Extends the sums to `to` and drops those before `from`.
    fn keep(&mut self, from: usize, to: usize) {
        while self.first + self.kept.len() <= to {
            let (mut sum, mut count) = self.kept.back().copied().unwrap_or_default();
            if let Some(value) = self.values.next().filter(|value| !value.is_nan()) {
                sum += value - self.reference;
                count += 1;
            }
            self.kept.push_back((sum, count));
        }
        while self.first < from {
            self.kept.pop_front();
            self.first += 1;
        }
    }

    /// Mean over rows, relative to the reference; `None` if all values are missing.
    fn mean(&self, from: usize, to: usize) -> Option<f64> {
        let [from, to] = [from, to].map(|row| self.kept.get(row.checked_sub(self.first)?));
        let ((from, before), (to, until)) = (from?, to?);
        let count = until - before;
        (count > 0).then(|| (to - from) / count as f64)
    }
}

/// Standard deviation of the noise, from the median of second differences, which motion hardly affects; long recordings are
/// thinned.
fn noise(values: &Values) -> f64 {
    let every = values.len().div_ceil(MOST_DIFFERENCES).max(1);
    let rows = (0..values.len().saturating_sub(2)).step_by(every);
    let second = rows.map(|row| {
        let [one, two, three] = [0, 1, 2].map(|k| values.at(row + k));
        (one - 2.0 * two + three).abs()
    });
    let second = second.filter(|value| !value.is_nan());
    1.4826 * median(second).unwrap_or(0.0) / 6.0_f64.sqrt()
}

//! Where nothing moves.
//!
//! The speed of a channel at a row is the difference of its means over the two halves of a window around the row, divided
//! by half the window: noise averages out, and one outlier is no motion. A row is at rest where every channel that moves
//! with the platform is slower than its limit.

use std::collections::VecDeque;
use std::ops::Range;

use tautline_core::robot::Robot;

use super::clock::usual_step;
use crate::median::median;
use crate::recipe::{Kind, Mapping, Quantity, Rest};
use crate::values::Values;

/// Sizes of the noise that a speed may have on top of its limit (standard deviations).
const NOISE: f64 = 4.0;
/// A step longer than this many usual steps ends a rest.
const GAP: f64 = 5.0;
/// Second differences whose median is the noise, at most.
const MOST_DIFFERENCES: usize = 100_000;

/// Fastest motion at rest, in units of each kind of quantity.
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
            Kind::Swivel | Kind::Inclination => self.turn,
            Kind::Commanded | Kind::Tracked if quantity.index > 2 => self.turn / 2.0,
            _ => self.speed,
        }
    }
}

/// Ranges of rows of the series `main` at rest, without the time that it takes to settle.
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
    // A row whose clock jumps or that follows a gap begins a new rest.
    let breaks = |row: usize| {
        let step = time_s[row] - time_s[row - 1];
        !(0.0..=GAP * usual).contains(&step)
    };
    // A row at rest has half a window of rest before and after it: that long the platform has settled already.
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

/// Sums of the values before a row, relative to the first one, and how many there are: for the rows of a window that moves on.
struct Sums<'a> {
    values: Box<dyn Iterator<Item = f64> + 'a>,
    reference: f64,
    /// Row of the first sum that is kept.
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

    /// Goes on to the sum before `to`, and forgets those before `from`.
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

    /// Mean of the values of some rows, relative to the reference; none where all are missing.
    fn mean(&self, from: usize, to: usize) -> Option<f64> {
        let [from, to] = [from, to].map(|row| self.kept.get(row.checked_sub(self.first)?));
        let ((from, before), (to, until)) = (from?, to?);
        let count = until - before;
        (count > 0).then(|| (to - from) / count as f64)
    }
}

/// Standard deviation of the noise: the median of second differences, which motion hardly changes; of long recordings that of
/// every so many.
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

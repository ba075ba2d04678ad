//! Where nothing moves.
//!
//! The speed of a channel at a row is the difference of its means over the two halves of a window around the row, divided
//! by half the window: noise averages out, and one outlier is no motion. A row is at rest where every channel that moves
//! with the platform is slower than its limit.

use std::ops::Range;

use tautline_core::robot::Robot;

use super::clock::usual_step;
use crate::median::median;
use crate::recipe::{Kind, Mapping, Quantity, Rest};

/// Sizes of the noise that a speed may have on top of its limit (standard deviations).
const NOISE: f64 = 4.0;
/// A step longer than this many usual steps ends a rest.
const GAP: f64 = 5.0;

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
fn mark_motion(values: &[f64], half: usize, half_s: f64, limit: f64, still: &mut [bool]) {
    let sd = noise(values);
    let allowed = limit + NOISE * sd * (2.0 / half as f64).sqrt() / half_s;
    // Sums from the beginning, of values relative to the first one, and of how many there are.
    let first = values
        .iter()
        .copied()
        .find(|value| !value.is_nan())
        .unwrap_or(0.0);
    let mut sums = Vec::with_capacity(values.len() + 1);
    sums.push((0.0, 0_usize));
    let (mut sum, mut count) = (0.0, 0);
    for value in values {
        if !value.is_nan() {
            sum += value - first;
            count += 1;
        }
        sums.push((sum, count));
    }
    let mean = |from: usize, to: usize| {
        let count = sums[to].1 - sums[from].1;
        (count > 0).then(|| (sums[to].0 - sums[from].0) / count as f64)
    };
    for (row, still) in still.iter_mut().enumerate() {
        // Near the ends the window is shorter, and the halves with it.
        let reach = half.min(row.max(1)).min((values.len() - row).max(1));
        let (before, after) = (
            mean(row.saturating_sub(reach), row),
            mean(row, (row + reach).min(values.len())),
        );
        if let (Some(before), Some(after)) = (before, after) {
            let widened = (half as f64 / reach as f64).sqrt();
            let speed = (after - before).abs() / (half_s * reach as f64 / half as f64);
            let allowed = limit + (allowed - limit) * widened.powi(3);
            *still &= speed <= allowed;
        }
    }
}

/// Standard deviation of the noise: the median of second differences, which motion hardly changes.
fn noise(values: &[f64]) -> f64 {
    let second = values
        .windows(3)
        .map(|three| (three[0] - 2.0 * three[1] + three[2]).abs());
    let second = second.filter(|value| !value.is_nan());
    1.4826 * median(second).unwrap_or(0.0) / 6.0_f64.sqrt()
}

//! Robust regression lines through readings.

use crate::median::median;

/// `reading = intercept + slope expected`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line {
    /// 1 if sign, unit and channel are right.
    pub slope: f64,
    /// Scatter about the line relative to the scatter of the readings.
    pub scatter: f64,
}

/// A line with a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Step {
    /// First row after the step.
    pub row: usize,
    /// Size of the step, positive if readings increase.
    pub size: f64,
    /// Slope of the line.
    pub slope: f64,
}

/// Minimum number of readings for a line, and on either side of a step.
const FEWEST: usize = 6;
const BESIDE: usize = 3;
/// Largest part of a turn by which readings may be off besides whole ones.
const LARGEST_PART: f64 = 0.3;
/// Maximum number of rows at which a step is tried.
const PLACES: usize = 200;

/// Regression line, refitted without outliers; `None` if there are too few readings or they do not vary.
pub(crate) fn fit(expected: &[f64], readings: &[f64]) -> Option<Line> {
    let mut pairs: Vec<(f64, f64)> = expected
        .iter()
        .zip(readings)
        .map(|(x, y)| (*x, *y))
        .filter(|(x, y)| x.is_finite() && y.is_finite())
        .collect();
    let spread = scatter(pairs.iter().map(|(_, y)| *y));
    for _ in 0..3 {
        let line = least_squares(&pairs)?;
        let off = |(x, y): &(f64, f64)| (y - line.0 - line.1 * x).abs();
        let limit = 5.0
            * median(pairs.iter().map(off))
                .unwrap_or(0.0)
                .max(1e-12 * spread);
        let before = pairs.len();
        let near: Vec<(f64, f64)> = pairs
            .iter()
            .copied()
            .filter(|pair| off(pair) <= limit)
            .collect();
        // More than a fifth of the readings cannot be outliers.
        if near.len() == before || near.len() * 10 < before * 8 {
            break;
        }
        pairs = near;
    }
    let (intercept, slope) = least_squares(&pairs)?;
    let rest = scatter(pairs.iter().map(|(x, y)| y - intercept - slope * x));
    (spread > 0.0).then_some(Line {
        slope,
        scatter: rest / spread,
    })
}

/// The step that reduces the scatter about a line several times over, if there is one.
pub(super) fn best_step(expected: &[f64], readings: &[f64]) -> Option<Step> {
    let rows: Vec<usize> = (0..readings.len())
        .filter(|k| expected[*k].is_finite() && readings[*k].is_finite())
        .collect();
    if rows.len() < 2 * FEWEST {
        return None;
    }
    let pairs: Vec<(f64, f64)> = rows.iter().map(|k| (expected[*k], readings[*k])).collect();
    let plain = squares(&pairs, least_squares(&pairs)?);
    let stride = (rows.len() / PLACES).max(1);
    let mut best: Option<(f64, usize, f64, f64)> = None;
    for split in (BESIDE..=rows.len() - BESIDE).step_by(stride) {
        let Some((line, size)) = with_step(&pairs, split) else {
            continue;
        };
        let moved: Vec<(f64, f64)> = pairs
            .iter()
            .enumerate()
            .map(|(k, (x, y))| (*x, if k < split { *y } else { y - size }))
            .collect();
        let rest = squares(&moved, line);
        if best.is_none_or(|(least, ..)| rest < least) {
            best = Some((rest, split, size, line.1));
        }
    }
    let (rest, split, size, slope) = best?;
    let sd = (rest / (rows.len() as f64 - 3.0)).sqrt();
    let spread = scatter(pairs.iter().map(|(_, y)| *y));
    let is_step = rest < 0.1 * plain && size.abs() > 8.0 * sd && sd < 0.15 * spread;
    is_step.then(|| Step {
        row: rows[split],
        size,
        slope,
    })
}

/// Rows at which readings in turns jump by whole turns, each with the jump, if the readings are right otherwise: they are off by
/// less than a third of a turn besides, and the jumps are few.
pub(super) fn whole_turns(expected: &[f64], readings: &[f64]) -> Vec<(usize, f64)> {
    let mut jumps: Vec<(usize, f64)> = Vec::new();
    let mut turns = 0.0;
    let mut since = 0;
    for (row, off) in readings
        .iter()
        .zip(expected)
        .map(|(y, x)| y - x)
        .enumerate()
    {
        if !off.is_finite() {
            continue;
        }
        if (off - off.round()).abs() > LARGEST_PART {
            return Vec::new();
        }
        if off.round() != turns {
            if since < BESIDE {
                return Vec::new();
            }
            jumps.push((row, off.round() - turns));
            (turns, since) = (off.round(), 0);
        }
        since += 1;
    }
    if since < BESIDE { Vec::new() } else { jumps }
}

/// Intercept and slope.
fn least_squares(pairs: &[(f64, f64)]) -> Option<(f64, f64)> {
    if pairs.len() < FEWEST {
        return None;
    }
    let count = pairs.len() as f64;
    let (mx, my) = pairs.iter().fold((0.0, 0.0), |(mx, my), (x, y)| {
        (mx + x / count, my + y / count)
    });
    let (mut sxx, mut sxy) = (0.0, 0.0);
    for (x, y) in pairs {
        sxx += (x - mx) * (x - mx);
        sxy += (x - mx) * (y - my);
    }
    let slope = sxy / sxx;
    (sxx > 0.0 && slope.is_finite()).then_some((my - slope * mx, slope))
}

/// Line and step at a given split by least squares: removing the means of both sides leaves the slope.
fn with_step(pairs: &[(f64, f64)], split: usize) -> Option<((f64, f64), f64)> {
    let mean = |part: &[(f64, f64)]| {
        let count = part.len() as f64;
        part.iter().fold((0.0, 0.0), |(mx, my), (x, y)| {
            (mx + x / count, my + y / count)
        })
    };
    let (before, after) = pairs.split_at(split);
    let (first, second) = (mean(before), mean(after));
    let (mut sxx, mut sxy) = (0.0, 0.0);
    for (part, (mx, my)) in [(before, first), (after, second)] {
        for (x, y) in part {
            sxx += (x - mx) * (x - mx);
            sxy += (x - mx) * (y - my);
        }
    }
    let slope = sxy / sxx;
    let intercept = first.1 - slope * first.0;
    let size = second.1 - slope * second.0 - intercept;
    (sxx > 0.0 && slope != 0.0).then_some(((intercept, slope), size))
}

fn squares(pairs: &[(f64, f64)], (intercept, slope): (f64, f64)) -> f64 {
    pairs
        .iter()
        .map(|(x, y)| (y - intercept - slope * x).powi(2))
        .sum()
}

/// Standard deviation.
fn scatter(values: impl Iterator<Item = f64> + Clone) -> f64 {
    let count = values.clone().count() as f64;
    let mean = values.clone().sum::<f64>() / count;
    (values.map(|value| (value - mean).powi(2)).sum::<f64>() / count).sqrt()
}

//! Coarse alignment of two recordings of one motion: the lag of maximum correlation between the speeds of their channels.

use super::Recording;

/// Maximum number of points at which speeds are compared; the fit refines the lag.
const POINTS: usize = 3000;
/// Minimum overlap, as a fraction of the shorter recording.
const OVERLAP: f64 = 0.3;
/// Minimum correlation between recordings of one motion.
const ALIKE: f64 = 0.5;

/// Lag (s) to be added to the times of `other`; `None` if the recordings correlate at no lag.
pub(super) fn lag(reference: &Recording, other: &Recording) -> Option<f64> {
    let span = |one: &Recording| one.time_s[one.time_s.len() - 1] - one.time_s[0];
    let step = span(reference).max(span(other)) / POINTS as f64;
    let usual = |one: &Recording| span(one) / one.time_s.len() as f64;
    let step = step.max(usual(reference)).max(usual(other));
    if !(step > 0.0 && step.is_finite()) {
        return None;
    }
    let (a, b) = (activity(reference, step), activity(other, step));
    let least = (OVERLAP * a.len().min(b.len()) as f64).max(8.0) as isize;
    let (first, last) = (least - b.len() as isize, a.len() as isize - least);
    let likeness = |shift: isize| correlation(&a, &b, shift);
    let best = (first..=last).max_by(|p, q| likeness(*p).total_cmp(&likeness(*q)))?;
    if likeness(best) < ALIKE {
        return None;
    }
    Some(reference.time_s[0] - other.time_s[0] + best as f64 * step)
}

/// Speed of all channels together on a uniform time grid, each channel scaled by its standard deviation.
fn activity(recording: &Recording, step: f64) -> Vec<f64> {
    let time_s = &recording.time_s;
    let count = ((time_s[time_s.len() - 1] - time_s[0]) / step) as usize;
    let mut squares = vec![0.0; count];
    for channel in &recording.channels {
        let mean = channel.iter().sum::<f64>() / channel.len() as f64;
        let variance =
            channel.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / channel.len() as f64;
        let mut at = Sampler::new(time_s, channel);
        let mut last = at.value(time_s[0]);
        for (k, square) in squares.iter_mut().enumerate() {
            let next = at.value(time_s[0] + (k + 1) as f64 * step);
            *square += (next - last).powi(2) / variance;
            last = next;
        }
    }
    // A moving average of three, because steps and samples do not coincide.
    let smooth = squares
        .windows(3)
        .map(|three| (three.iter().sum::<f64>() / 3.0).sqrt());
    smooth.collect()
}

/// Correlation over the overlap if `b` begins `shift` steps after `a`.
fn correlation(a: &[f64], b: &[f64], shift: isize) -> f64 {
    let from = shift.max(0) as usize;
    let until = (b.len() as isize + shift).min(a.len() as isize).max(0) as usize;
    if until <= from {
        return f64::NEG_INFINITY;
    }
    let a = &a[from..until];
    let b = &b[(from as isize - shift) as usize..(until as isize - shift) as usize];
    let count = a.len() as f64;
    let (mut sums, mut squares, mut product) = ([0.0; 2], [0.0; 2], 0.0);
    for (a, b) in a.iter().zip(b) {
        sums[0] += a;
        sums[1] += b;
        squares[0] += a * a;
        squares[1] += b * b;
        product += a * b;
    }
    let covariance = product - sums[0] * sums[1] / count;
    let variances =
        (squares[0] - sums[0] * sums[0] / count) * (squares[1] - sums[1] * sums[1] / count);
    if variances > 0.0 {
        covariance / variances.sqrt()
    } else {
        f64::NEG_INFINITY
    }
}

/// Linear interpolation of a channel at ascending times.
pub(super) struct Sampler<'a> {
    time_s: &'a [f64],
    values: &'a [f64],
    at: usize,
}

impl<'a> Sampler<'a> {
    pub fn new(time_s: &'a [f64], values: &'a [f64]) -> Self {
        Self {
            time_s,
            values,
            at: 0,
        }
    }

    /// Value at a time, which must not precede that of the previous call.
    pub fn value(&mut self, time: f64) -> f64 {
        while self.at + 2 < self.time_s.len() && self.time_s[self.at + 1] < time {
            self.at += 1;
        }
        let (from, to) = (self.time_s[self.at], self.time_s[self.at + 1]);
        let part = ((time - from) / (to - from)).clamp(0.0, 1.0);
        self.values[self.at] + part * (self.values[self.at + 1] - self.values[self.at])
    }
}

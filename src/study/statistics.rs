//! Statistics that are bit-for-bit independent of the order of values and of merging.
//!
//! Sums are whole numbers: a value in millimetres squared is rounded to a multiple of 2^-60 and added in 128 bits. Quantiles
//! come from counts by the leading bits of a value, as in DDSketch (Masson, Rim, Lee, VLDB 2019) with the bits of the
//! binary number in the place of a logarithm, so that no library's rounding matters: each bin is at most 1/64 wide.

use std::collections::BTreeMap;

/// Number of fractional bits of sums.
const FRACTION_BITS: i32 = 60;
/// Bits of the significand that define a bin of the sketch.
const SKETCH_BITS: u32 = 6;

/// A sum of values that does not depend on their order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct ExactSum(i128);

impl ExactSum {
    /// Adds a value, rounded to a multiple of 2^-60; saturates on overflow.
    pub fn add(&mut self, value: f64) {
        // Scaling by a power of two is exact, and so is the conversion of what is left below 2^127.
        let scaled = (value * f64::from(FRACTION_BITS).exp2()).round();
        self.0 = self.0.saturating_add(scaled as i128);
    }

    /// Adds another sum.
    pub fn merge(&mut self, other: Self) {
        self.0 = self.0.saturating_add(other.0);
    }

    /// The sum.
    #[must_use]
    pub fn value(self) -> f64 {
        self.0 as f64 * f64::from(-FRACTION_BITS).exp2()
    }
}

/// Counts of positive values by their leading bits.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Sketch(BTreeMap<u64, u64>);

impl Sketch {
    /// Counts a value; zero and negative values count as the smallest.
    pub fn add(&mut self, value: f64) {
        *self
            .0
            .entry(value.max(0.0).to_bits() >> (52 - SKETCH_BITS))
            .or_default() += 1;
    }

    /// Adds the counts of another sketch.
    pub fn merge(&mut self, other: &Self) {
        for (bin, count) in &other.0 {
            *self.0.entry(*bin).or_default() += count;
        }
    }

    /// The quantile of a fraction, as the middle of its bin; `None` without values.
    #[must_use]
    pub fn quantile(&self, part: f64) -> Option<f64> {
        let all: u64 = self.0.values().sum();
        let wanted = (part * all as f64).ceil().max(1.0) as u64;
        let mut seen = 0;
        let bin = self.0.iter().find_map(|(bin, count)| {
            seen += count;
            (seen >= wanted).then_some(*bin)
        })?;
        let edge = |bin: u64| f64::from_bits(bin << (52 - SKETCH_BITS));
        Some(f64::midpoint(edge(bin), edge(bin + 1)))
    }
}

/// Distribution of an error: mean square with its standard error, and quantiles.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct ErrorStatistics {
    count: u64,
    squares: ExactSum,
    fourths: ExactSum,
    sketch: Sketch,
}

/// Millimetres per metre: sums are in mm², so that typical values are about 1.
const MM: f64 = 1e3;
/// Errors above this limit (mm) have diverged and are clipped to it.
const LARGEST_MM: f64 = 1e4;

impl ErrorStatistics {
    /// Counts an error (m).
    pub fn add(&mut self, error_m: f64) {
        let error = (error_m * MM).min(LARGEST_MM);
        let square = error * error;
        self.count += 1;
        self.squares.add(square);
        self.fourths.add(square * square);
        self.sketch.add(error);
    }

    /// Merges the statistics of another part.
    pub fn merge(&mut self, other: &Self) {
        self.count += other.count;
        self.squares.merge(other.squares);
        self.fourths.merge(other.fourths);
        self.sketch.merge(&other.sketch);
    }

    /// Root mean square (m); `None` without values.
    #[must_use]
    pub fn rms_m(&self) -> Option<f64> {
        Some(self.mean_square()?.sqrt() / MM)
    }

    /// Relative standard error of the root mean square: half of that of the mean square.
    #[must_use]
    pub fn relative_standard_error(&self) -> Option<f64> {
        let mean = self.mean_square().filter(|mean| *mean > 0.0)?;
        let count = self.count as f64;
        let variance = (self.fourths.value() / count - mean * mean).max(0.0);
        Some(0.5 * (variance / count).sqrt() / mean)
    }

    /// The quantile (m) of a fraction.
    #[must_use]
    pub fn quantile_m(&self, part: f64) -> Option<f64> {
        self.sketch.quantile(part).map(|error| error / MM)
    }

    fn mean_square(&self) -> Option<f64> {
        (self.count > 0).then(|| self.squares.value() / self.count as f64)
    }
}

#[cfg(test)]
mod tests {
    use rand::RngExt;

    use super::*;
    use crate::design::stream;

    #[test]
    fn order_and_parts_do_not_matter() {
        let mut rng = stream(5, 1);
        let errors: Vec<f64> = (0..2000)
            .map(|_| 10_f64.powf(rng.random_range(-6.0..-1.0)))
            .collect();
        let of = |errors: &mut dyn Iterator<Item = f64>| {
            let mut all = ErrorStatistics::default();
            errors.for_each(|error| all.add(error));
            all
        };
        let whole = of(&mut errors.iter().copied());
        assert_eq!(whole, of(&mut errors.iter().rev().copied()));
        for parts in [2, 7, 100] {
            let mut merged = ErrorStatistics::default();
            for part in errors.chunks(errors.len().div_ceil(parts)).rev() {
                merged.merge(&of(&mut part.iter().copied()));
            }
            assert_eq!(merged, whole);
        }
        let plain = (errors.iter().map(|e| e * e).sum::<f64>() / 2000.0).sqrt();
        assert!((whole.rms_m().expect("values") / plain - 1.0).abs() < 1e-12);
    }

    #[test]
    fn quantiles_are_right_to_one_bin() {
        let mut sketch = Sketch::default();
        (1..=1000).for_each(|value| sketch.add(f64::from(value)));
        for part in [0.05, 0.5, 0.95, 1.0] {
            let found = sketch.quantile(part).expect("values");
            assert!(
                (found / (1000.0 * part) - 1.0).abs() < 1.0 / 64.0,
                "{part} {found}"
            );
        }
        assert_eq!(Sketch::default().quantile(0.5), None);
    }

    #[test]
    fn the_error_of_normal_errors_is_that_of_theory() {
        let mut all = ErrorStatistics::default();
        let mut rng = stream(6, 1);
        for _ in 0..20_000 {
            // The sum of twelve uniform numbers is normal enough: kurtosis 2.9.
            let sum: f64 = (0..12).map(|_| rng.random_range(-0.5..0.5)).sum();
            all.add(1e-3 * sum.abs());
        }
        assert!((all.rms_m().expect("values") - 1e-3).abs() < 5e-5);
        let theory = 0.5 * (1.9_f64 / 20_000.0).sqrt();
        assert!((all.relative_standard_error().expect("values") / theory - 1.0).abs() < 0.1);
    }

    #[test]
    fn what_diverged_does_not_overflow() {
        let mut all = ErrorStatistics::default();
        for _ in 0..1000 {
            all.add(f64::INFINITY);
        }
        assert_eq!(all.rms_m(), Some(10.0));
    }
}

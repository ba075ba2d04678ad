//! Value and derivatives of sampled readings, by a polynomial fitted to a window of samples.
//!
//! Savitzky and Golay, Analytical Chemistry 36 (1964) 1627, for samples at arbitrary times. A quintic over half a second
//! reproduces a motion of 1 Hz, one over two seconds a motion of a quarter of that.

use nalgebra::{SMatrix, SVector};

/// Number of coefficients of the polynomial.
const TERMS: usize = 6;
/// Smallest number of samples in a window.
pub(super) const FEWEST: usize = 2 * TERMS + 1;

/// Weights that map the samples of a window to the value at its centre, and to its first and second time derivative.
#[derive(Debug, Clone)]
pub(super) struct Weights([Vec<f64>; 3]);

impl Weights {
    /// Weights for samples at these times (s) relative to the centre; `None` if they are too few or too close together.
    pub fn new(times_s: &[f64]) -> Option<Self> {
        let half = times_s.iter().fold(0.0_f64, |most, t| most.max(t.abs()));
        if times_s.len() < FEWEST || half <= 0.0 {
            return None;
        }
        let powers =
            |t: &f64| SVector::<f64, TERMS>::from_fn(|order, _| (t / half).powi(order as i32));
        let rows: Vec<SVector<f64, TERMS>> = times_s.iter().map(powers).collect();
        let products = rows.iter().map(|row| row * row.transpose());
        let normal: SMatrix<f64, TERMS, TERMS> = products.sum();
        let inverse = normal.cholesky()?.inverse();
        let of = |order: usize, factor: f64| {
            let coefficients = inverse.row(order) * (factor / half.powi(order as i32));
            rows.iter().map(|row| (coefficients * row)[0]).collect()
        };
        Some(Self([of(0, 1.0), of(1, 1.0), of(2, 2.0)]))
    }

    /// Value, first and second derivative.
    pub fn apply(&self, samples: impl Fn(usize) -> f64) -> [f64; 3] {
        let sum = |weights: &Vec<f64>| {
            let terms = weights.iter().enumerate().map(|(k, w)| w * samples(k));
            terms.sum()
        };
        [sum(&self.0[0]), sum(&self.0[1]), sum(&self.0[2])]
    }

    /// Weights that map the samples to the residual at the centre: the sample there less the fitted value.
    pub fn residual(&self) -> Vec<f64> {
        let mut residual: Vec<f64> = self.0[0].iter().map(|w| -w).collect();
        residual[self.0[0].len() / 2] += 1.0;
        residual
    }
}

/// Value and derivatives of samples with gaps (NaN); NaN if too many are missing.
pub(super) fn derivatives(
    times_s: &[f64],
    weights: &Weights,
    samples: impl Fn(usize) -> f64,
) -> [f64; 3] {
    let there: Vec<usize> = (0..times_s.len())
        .filter(|k| samples(*k).is_finite())
        .collect();
    if there.len() == times_s.len() {
        return weights.apply(samples);
    }
    // With more missing, the remaining samples may all be on one side.
    if 4 * there.len() < 3 * times_s.len() {
        return [f64::NAN; 3];
    }
    let times: Vec<f64> = there.iter().map(|k| times_s[*k]).collect();
    Weights::new(&times).map_or([f64::NAN; 3], |own| own.apply(|k| samples(there[k])))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quintic_is_reproduced_and_missing_samples_do_no_harm() {
        let polynomial = |t: f64| 1.0 + t * (2.0 - t * (3.0 - t * (4.0 + t * (5.0 - 6.0 * t))));
        let times: Vec<f64> = (-20..=20)
            .map(|k| 0.01 * f64::from(k) + 1e-3 * f64::from(k % 3))
            .collect();
        let weights = Weights::new(&times).unwrap();
        for missing in [None, Some(3), Some(20)] {
            let samples = |k: usize| match missing == Some(k) {
                true => f64::NAN,
                false => polynomial(times[k]),
            };
            let found = derivatives(&times, &weights, samples);
            for (value, expected) in found.into_iter().zip([1.0, 2.0, -6.0]) {
                assert!((value - expected).abs() < 1e-9, "{found:?}");
            }
        }
        let few = |k: usize| if k < 20 { f64::NAN } else { 1.0 };
        assert!(derivatives(&times, &weights, few)[0].is_nan());
        assert!(Weights::new(&times[..6]).is_none());
    }
}

//! Histograms of standardised residuals with the normal density expected of them.

use std::f64::consts::TAU;

/// Counts values in bins of equal width between `-reach` and `reach`; the outermost bins include values beyond.
/// Returns the edges, one more than bins, and the counts.
#[must_use]
pub fn histogram(values: &[f64], reach: f64, bins: usize) -> (Vec<f64>, Vec<f64>) {
    let width = 2.0 * reach / bins as f64;
    let mut counts = vec![0.0; bins];
    for value in values {
        let bin = ((value + reach) / width).clamp(0.0, bins as f64 - 1.0);
        counts[bin as usize] += 1.0;
    }
    let edges = (0..=bins).map(|k| -reach + width * k as f64);
    (edges.collect(), counts)
}

/// The standard normal density between `-reach` and `reach`, times `area`.
#[must_use]
pub fn normal(reach: f64, area: f64) -> Vec<[f64; 2]> {
    const STEPS: i32 = 120;
    (-STEPS..=STEPS)
        .map(|k| {
            let x = reach * f64::from(k) / f64::from(STEPS);
            [x, area * (-0.5 * x * x).exp() / TAU.sqrt()]
        })
        .collect()
}

//! 95 % regions of points in a plane.

use std::f64::consts::TAU;

use nalgebra::{Matrix2, SymmetricEigen, Vector2};

/// Upper 5 % points of chi-square with one and two degrees of freedom.
const QUANTILES: [f64; 2] = [3.841, 5.991];
/// Number of points along an ellipse.
const STEPS: usize = 72;

/// Semi-axes of the 95 % region of a point with this covariance: `d^T P^-1 d = q`, with the 95 % point `q` of
/// chi-square for one or two degrees of freedom. `None` for a point without uncertainty.
pub fn region(covariance: &Matrix2<f64>) -> Option<[Vector2<f64>; 2]> {
    let eigen = SymmetricEigen::new(*covariance);
    let largest = eigen.eigenvalues.max();
    if !(largest.is_finite() && largest > 0.0) {
        return None;
    }
    let rank = eigen.eigenvalues.iter().filter(|v| **v > 1e-9 * largest);
    let quantile = QUANTILES[(rank.count() - 1).min(1)];
    let half =
        |k: usize| eigen.eigenvectors.column(k) * (quantile * eigen.eigenvalues[k].max(0.0)).sqrt();
    Some([half(0), half(1)])
}

/// Boundary of the 95 % region about `centre`.
pub fn boundary(centre: Vector2<f64>, [a, b]: [Vector2<f64>; 2]) -> Vec<Vector2<f64>> {
    let at = |k: usize| {
        let (sin, cos) = (TAU * k as f64 / STEPS as f64).sin_cos();
        centre + a * cos + b * sin
    };
    (0..STEPS).map(at).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_given_has_no_region_and_a_line_has_one() {
        assert!(region(&Matrix2::zeros()).is_none());
        let flat = region(&Matrix2::new(4.0, 0.0, 0.0, 0.0)).expect("a region");
        let lengths = flat.map(|axis| axis.norm());
        let (long, short) = (lengths[0].max(lengths[1]), lengths[0].min(lengths[1]));
        assert!((long - 2.0 * 3.841_f64.sqrt()).abs() < 1e-12 && short == 0.0);
    }
}

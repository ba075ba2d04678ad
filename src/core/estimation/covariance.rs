//! The inverse of an information matrix.

use nalgebra::DMatrix;

use crate::tolerances::SINGULAR_PIVOT;

/// Inverse of a symmetric information matrix, which is the covariance of its parameters; `None` if it is
/// singular to working precision.
#[must_use]
pub fn covariance_of(information: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let factor = information.clone().cholesky()?;
    is_regular(factor.l_dirty(), information).then(|| factor.inverse())
}

/// Whether no pivot of a Cholesky factor is zero to working precision.
pub(crate) fn is_regular(factor: &DMatrix<f64>, matrix: &DMatrix<f64>) -> bool {
    let pivots = factor.diagonal();
    let scale = matrix.diagonal();
    pivots
        .iter()
        .zip(&scale)
        .all(|(l, d)| l * l > SINGULAR_PIVOT * d)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_singular_information_has_no_covariance() {
        let regular = DMatrix::from_row_slice(2, 2, &[2.0, 1.0, 1.0, 2.0]);
        let covariance = covariance_of(&regular).unwrap();
        assert!((covariance[(0, 0)] - 2.0 / 3.0).abs() < 1e-15);
        let singular = DMatrix::from_row_slice(2, 2, &[1.0, 1.0, 1.0, 1.0 + 1e-13]);
        assert!(covariance_of(&singular).is_none());
    }
}

//! Generalised least squares of a difference: `d = X b + e` with the covariance `S` of `e`.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use crate::estimation::covariance_of;

/// A difference `d` with the Cholesky factor of its covariance `S`.
pub(super) struct Difference {
    pub value: DVector<f64>,
    factor: Cholesky<f64, Dyn>,
}

/// Generalised least-squares estimate for a design matrix `X`.
pub(super) struct Solved {
    /// `b = (X^T S^-1 X)^-1 X^T S^-1 d`.
    pub estimate: DVector<f64>,
    /// `(X^T S^-1 X)^-1`.
    pub covariance: DMatrix<f64>,
    /// `(d - X b)^T S^-1 (d - X b)`.
    pub chi2: f64,
}

impl Difference {
    /// `None` if the covariance is not positive definite.
    pub fn new(value: DVector<f64>, covariance: DMatrix<f64>) -> Option<Self> {
        Some(Self {
            value,
            factor: covariance.cholesky()?,
        })
    }

    /// `None` if the difference does not determine `b`.
    pub fn solve(&self, design: &DMatrix<f64>) -> Option<Solved> {
        let weighted = self.factor.solve(design);
        let covariance = covariance_of(&design.tr_mul(&weighted))?;
        let estimate = &covariance * weighted.tr_mul(&self.value);
        let residual = &self.value - design * &estimate;
        Some(Solved {
            chi2: residual.dot(&self.factor.solve(&residual)),
            estimate,
            covariance,
        })
    }
}

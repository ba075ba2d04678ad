//! The linear problem without the parameters that every set of causes has.

use nalgebra::{DMatrix, DVector};

use super::conditions::Noise;

/// The problem at given hyperparameters, with the background and the parameters that are always estimated eliminated.
pub(super) struct ReducedProblem<'l> {
    pub noise: Noise<'l>,
    /// `U^T`, where `1 - U U^T` is the projection of whitened conditions by the elimination.
    pub eliminated: DMatrix<f64>,
    /// Whitened and projected residual.
    pub residual: DVector<f64>,
    /// Weighted sum of squared residuals, including those of the parameters with priors.
    pub chi2: f64,
    /// Log density of the readings.
    pub log_evidence: f64,
}

//! Parameters of a least-squares fit and their uncertainties.

use nalgebra::DMatrix;

/// Parameters of a least-squares fit with their uncertainties.
///
/// With `W = diag(1/sd_i^2)` of the observations (1 where none is given) and `J` the derivative of the
/// prediction, the cofactor is `Q = (J^T W J)^-1`, the residual variance `s^2 = sum (e_i/sd_i)^2 / dof` and
/// the covariance `s^2 Q` (Bjorck, *Numerical Methods for Least Squares Problems*, section 1.1).
/// If the standard deviations of the observations are trusted, use the cofactor instead.
#[derive(Debug, Clone, PartialEq)]
pub struct FitStatistics {
    /// Estimates of the parameters, in the order of the columns of the design.
    pub parameters: Vec<f64>,
    /// Standard deviation of each parameter; NaN without redundancy, infinite if undetermined.
    pub standard_deviations: Vec<f64>,
    /// Covariance of the parameters (parameters x parameters), scaled by the residual variance.
    pub covariance: DMatrix<f64>,
    /// Cofactor of the parameters (parameters x parameters): their covariance if the observations' `sd` are true.
    pub cofactor: DMatrix<f64>,
    /// Observation minus prediction, in units of the observations.
    pub residuals: Vec<f64>,
    /// Residual standard deviation `s`, relative to the observations' `sd`; NaN without redundancy.
    pub residual_sd: f64,
    /// Degrees of freedom: observations minus determined parameters.
    pub dof: usize,
    /// Number of parameters, or combinations of them, that the observations determine.
    pub rank: usize,
    /// Parameters that the observations do not determine; empty if the rank is full.
    pub undetermined: Vec<usize>,
}

impl FitStatistics {
    /// Whether the observations determine every parameter.
    #[must_use]
    pub fn is_full_rank(&self) -> bool {
        self.rank == self.parameters.len()
    }

    /// The largest absolute residual, in units of the observations; 0 without observations.
    #[must_use]
    pub fn largest_residual(&self) -> f64 {
        self.residuals
            .iter()
            .fold(0.0, |largest, e| largest.max(e.abs()))
    }

    /// Computes the statistics; `weighted_square_sum` is `sum (e_i/sd_i)^2`.
    pub(super) fn new(
        parameters: Vec<f64>,
        residuals: Vec<f64>,
        weighted_square_sum: f64,
        cofactor: DMatrix<f64>,
        rank: usize,
    ) -> Self {
        let dof = residuals.len().saturating_sub(rank);
        let variance = if dof > 0 {
            weighted_square_sum / dof as f64
        } else {
            f64::NAN
        };
        let is_undetermined = |k: &usize| cofactor[(*k, *k)].is_infinite();
        let undetermined: Vec<usize> = (0..parameters.len()).filter(is_undetermined).collect();
        let mut covariance = &cofactor * variance;
        for k in &undetermined {
            // With an exact fit the product would be 0 * infinity and hide the defect.
            covariance[(*k, *k)] = f64::INFINITY;
        }
        Self {
            standard_deviations: covariance.diagonal().iter().map(|v| v.sqrt()).collect(),
            parameters,
            covariance,
            cofactor,
            residuals,
            residual_sd: variance.sqrt(),
            dof,
            rank,
            undetermined,
        }
    }
}

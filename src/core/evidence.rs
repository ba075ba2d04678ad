//! Evidence of parameters of a linear model, in closed form.
//!
//! Parameters `F t` with independent standard normal `t` have the log evidence, relative to parameters that are zero,
//! `1/2 c^T (1 + G)^-1 c - 1/2 log det(1 + G)` with `c = F^T b` and `G = F^T K F` from their score `b` and information `K`. The
//! determinant penalises parameters. A parameter that cannot be negative has a normal prior truncated at zero, which adds
//! [`log_positive`].

use nalgebra::{Cholesky, DMatrix, DVector, Dyn, SymmetricEigen};

use crate::statistics::log_normal_cdf;

/// Evidence of some parameters.
pub(crate) struct Evidence {
    /// Factor `L` of `1 + G`.
    pub factor: Cholesky<f64, Dyn>,
    /// `L^-1 c`.
    pub half: DVector<f64>,
}

impl Evidence {
    /// Evidence of parameters in units of their prior, from `c` and `G`; `None` if `1 + G` is not positive definite.
    pub fn new(mut score: DVector<f64>, mut information: DMatrix<f64>) -> Option<Self> {
        for k in 0..score.len() {
            information[(k, k)] += 1.0;
        }
        let factor = information.cholesky()?;
        factor.l_dirty().solve_lower_triangular_mut(&mut score);
        Some(Self {
            factor,
            half: score,
        })
    }

    /// Evidence of parameters with the prior covariance `F F^T`, from `b` and `K`.
    pub fn with_prior(
        score: &DVector<f64>,
        information: &DMatrix<f64>,
        prior: &DMatrix<f64>,
    ) -> Option<Self> {
        Self::new(prior.tr_mul(score), prior.tr_mul(information) * prior)
    }

    /// Half of the chi-square that the parameters explain.
    pub fn gain(&self) -> f64 {
        0.5 * self.half.norm_squared()
    }

    /// Log evidence.
    pub fn log(&self) -> f64 {
        self.gain() - 0.5 * log_determinant(&self.factor)
    }

    /// Estimate in units of the prior; residuals are predictions minus readings.
    pub fn mean(&self) -> DVector<f64> {
        let upper = self.factor.l_dirty().transpose();
        upper
            .solve_upper_triangular(&-&self.half)
            .unwrap_or_else(|| DVector::zeros(self.half.len()))
    }
}

/// Log evidence of one parameter in units of its prior.
pub(crate) fn of_one(score: f64, information: f64) -> f64 {
    let spread = 1.0 + information;
    0.5 * (score * score / spread - spread.ln())
}

/// Information and score along each principal direction of some parameters.
pub(crate) fn principal(score: &DVector<f64>, information: DMatrix<f64>) -> Vec<[f64; 2]> {
    let eigen = SymmetricEigen::new(information);
    let along = eigen.eigenvectors.tr_mul(score);
    let pairs = eigen.eigenvalues.iter().zip(&along);
    pairs
        .map(|(value, along)| [value.max(0.0), *along])
        .collect()
}

/// Chi-square that parameters of one standard deviation explain, and the log determinant, from [`principal`].
pub(crate) fn of_size(principal: &[[f64; 2]], size: f64) -> [f64; 2] {
    principal
        .iter()
        .fold([0.0, 0.0], |[gain, price], [information, score]| {
            let spread = 1.0 + size * size * information;
            [gain + (size * score).powi(2) / spread, price + spread.ln()]
        })
}

/// Log determinant of a factorised matrix.
pub(crate) fn log_determinant(factor: &Cholesky<f64, Dyn>) -> f64 {
    2.0 * factor.l_dirty().diagonal().map(f64::ln).sum()
}

/// Logarithm of twice the probability that a normal variable is positive.
pub(crate) fn log_positive(mean: f64, variance: f64) -> f64 {
    if variance <= 0.0 {
        return 0.0;
    }
    std::f64::consts::LN_2 + log_normal_cdf(mean / variance.sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The evidence of one parameter is the integral of the likelihood ratio over its prior.
    #[test]
    fn it_is_the_integral_over_the_prior() {
        let (score, information, sd): (f64, f64, f64) = (-3.0, 2.0, 0.7);
        let step = 1e-3;
        let density = |t: f64| {
            let x = sd * t;
            (-score * x - 0.5 * information * x * x - 0.5 * t * t).exp()
        };
        let sum: f64 = (-8000..=8000).map(|k| density(f64::from(k) * step)).sum();
        let integral = (sum * step / std::f64::consts::TAU.sqrt()).ln();
        assert!((of_one(score * sd, information * sd * sd) - integral).abs() < 1e-6);
        let vector = DVector::from_element(1, score);
        let matrix = DMatrix::from_element(1, 1, information);
        let prior = DMatrix::from_element(1, 1, sd);
        let evidence = Evidence::with_prior(&vector, &matrix, &prior).unwrap();
        assert!((evidence.log() - integral).abs() < 1e-6);
        let mean = sd * evidence.mean()[0];
        assert!((mean - -score / (information + sd.powi(-2))).abs() < 1e-12);
        let [gain, price] = of_size(&principal(&vector, matrix), sd);
        assert!((0.5 * (gain - price) - integral).abs() < 1e-6);
    }
}

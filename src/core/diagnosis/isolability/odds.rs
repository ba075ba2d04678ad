//! Posterior odds of one candidate against no cause as a function of its score: [`crate::evidence`] with the
//! matrices computed in advance.

use nalgebra::{DMatrix, DVector};

use crate::diagnosis::candidates::Candidate;
use crate::evidence::{log_determinant, log_positive};
use crate::statistics::log_sum;

/// Log posterior odds of one candidate as a function of its score.
pub(super) struct Evidence {
    log_odds: f64,
    scales: Vec<Scale>,
    is_positive: bool,
}

/// Evidence at one scale of the prior: `1/2 |K b|^2 + constant`, where `K = L^-1 F^T`, `F F^T` is the prior covariance
/// and `L L^T = 1 + F^T G F`. The constant has the determinant and the prior of the scale.
struct Scale {
    root: DMatrix<f64>,
    constant: f64,
}

impl Evidence {
    pub fn new(candidate: &Candidate, information: &DMatrix<f64>) -> Self {
        let scale = |(size, weight): &(f64, f64)| {
            let mut root = candidate.prior.transpose() * *size;
            let mut matrix = &root * information * root.transpose();
            for k in 0..matrix.nrows() {
                matrix[(k, k)] += 1.0;
            }
            let factor = matrix.cholesky()?;
            factor.l_dirty().solve_lower_triangular_mut(&mut root);
            Some(Scale {
                root,
                constant: weight - 0.5 * log_determinant(&factor),
            })
        };
        Self {
            log_odds: candidate.log_odds,
            scales: candidate.scales.iter().filter_map(scale).collect(),
            is_positive: candidate.is_positive,
        }
    }

    /// Log posterior odds, summed over all scales.
    pub fn log_odds(&self, score: &[f64]) -> f64 {
        self.log_odds + log_sum(self.scales.iter().map(|scale| self.at(scale, score)))
    }

    /// Bounds of the log posterior odds that need no exponential function: a sum is at least its largest term, and at most that
    /// times the number of terms.
    pub fn bounds(&self, score: &[f64]) -> [f64; 2] {
        let terms = self.scales.iter().map(|scale| self.at(scale, score));
        let least = self.log_odds + terms.fold(f64::NEG_INFINITY, f64::max);
        [least, least + (self.scales.len() as f64).ln()]
    }

    fn at(&self, scale: &Scale, score: &[f64]) -> f64 {
        let mut value = scale.constant;
        for row in 0..scale.root.nrows() {
            let products = scale.root.row(row).into_iter().zip(score);
            let sum: f64 = products.map(|(root, b)| root * b).sum();
            value += 0.5 * sum * sum;
        }
        if self.is_positive {
            // Mean of the parameter over its standard deviation, given the score.
            value += log_positive(-scale.root[(0, 0)] * score[0], 1.0);
        }
        value
    }

    /// Expected log evidence, without the prior odds, for a score of given mean and covariance, at the scale for which
    /// it is largest.
    pub fn expected(&self, mean: &DVector<f64>, covariance: &DMatrix<f64>) -> f64 {
        let value = |scale: &Scale| {
            let spread = (&scale.root * covariance * scale.root.transpose()).trace();
            self.at(scale, mean.as_slice()) + 0.5 * spread
        };
        self.scales
            .iter()
            .map(value)
            .fold(f64::NEG_INFINITY, f64::max)
    }
}

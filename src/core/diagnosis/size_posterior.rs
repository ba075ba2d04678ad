//! Posterior distribution of the size of a fault.

use nalgebra::{DMatrix, DVector};

use super::budget::{NEGLIGIBLE_ODDS, UNSEEN_POINTS};
use super::normal_points::normal_points;
use crate::statistics::{chi_square_survival, normal_cdf};

/// Posterior of the coordinates of a candidate at one scale, in units of the prior at that scale.
#[derive(Debug, Clone)]
pub(super) struct SizePosterior {
    /// Prior and posterior odds of any size.
    pub(super) prior_odds: f64,
    pub(super) odds: f64,
    /// The typical size.
    pub(super) typical: f64,
    pub(super) is_positive: bool,
    pub(super) mean: DVector<f64>,
    /// `R` with `R R^T` equal to the covariance.
    pub(super) root: DMatrix<f64>,
}

impl SizePosterior {
    /// Prior odds of a size of at least `factor` times the typical one: the coordinates are standard normal.
    pub(super) fn prior_odds_beyond(&self, factor: f64) -> f64 {
        let least = factor * self.typical;
        let freedom = self.mean.len() as f64;
        self.prior_odds * chi_square_survival(least * least, freedom).unwrap_or(0.0)
    }

    /// Posterior odds of such a size; zero if the scale is too improbable to matter.
    pub(super) fn odds_beyond(&self, factor: f64) -> f64 {
        if self.odds < NEGLIGIBLE_ODDS {
            return 0.0;
        }
        self.odds * self.share_beyond(factor * self.typical)
    }

    /// Probability of coordinates whose norm is at least `least`; twice that of positive ones where only those are possible.
    fn share_beyond(&self, least: f64) -> f64 {
        if self.mean.len() == 1 {
            let beyond = |mean: f64| normal_cdf((mean - least) / self.root[(0, 0)]);
            let mean = self.mean[0];
            return if self.is_positive {
                2.0 * beyond(mean)
            } else {
                beyond(mean) + beyond(-mean)
            };
        }
        let mut points = &self.root * normal_points(self.mean.len(), UNSEEN_POINTS);
        let beyond = points.column_iter_mut().filter_map(|mut point| {
            point += &self.mean;
            (point.norm() >= least).then_some(())
        });
        beyond.count() as f64 / UNSEEN_POINTS as f64
    }
}

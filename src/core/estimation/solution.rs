//! The result of a solve.

use nalgebra::DMatrix;

use super::globals::Globals;
use super::options::Termination;
use super::parameter::{Parameter, ParameterId};
use crate::cable::OutsideMeasuredRange;
use crate::geometry::Pose;
use crate::measurement::Grid;

/// Result of a solve. Non-convergence is a field, not an error.
#[derive(Debug, Clone)]
pub struct Solution {
    /// Common parameters at the solution.
    pub globals: Globals,
    /// Fitted poses with their rows in the measurements; the home row comes first if there is one.
    pub poses: Vec<(usize, Pose)>,
    /// Fitted tensions at the platform, `(row, cable)` (N); NaN where not read or not fitted.
    pub tensions_n: Grid,
    /// The estimated parameters, in the order of the covariance.
    pub parameters: Vec<Parameter>,
    /// Covariance of the parameters, parameters x parameters (products of their SI units); `None` if the data do not
    /// determine them.
    pub covariance: Option<DMatrix<f64>>,
    /// Information matrix of the parameters, the poses eliminated: the inverse of the covariance, parameters x parameters.
    pub information: DMatrix<f64>,
    /// Reason why the solve ended.
    pub termination: Termination,
    /// Number of steps taken.
    pub iterations: usize,
    /// Loss at the solution: chi-square for least squares, priors included.
    pub chi2: f64,
    /// Observations (readings, equilibrium equations, priors) minus unknowns.
    pub degrees_of_freedom: f64,
    /// Number of pose coordinates that the readings leave undetermined.
    pub undetermined_coordinates: usize,
    /// Cables at poses where their measured elongation had to be extrapolated: if there are any, the solution
    /// is not valid.
    pub outside_surface: Vec<OutsideSurface>,
}

/// A cable outside the range in which its elongation was measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OutsideSurface {
    /// Row of the measurements.
    pub row: usize,
    /// Index of the cable.
    pub cable: usize,
    /// The quantity outside its range.
    pub range: OutsideMeasuredRange,
}

impl Solution {
    /// Whether the solve ended at a minimum, where the predicted reduction of the loss is negligible. A solve that stalled, was
    /// cancelled or ran out of iterations has not converged, however small its last steps.
    #[must_use]
    pub fn converged(&self) -> bool {
        self.termination == Termination::Converged
    }

    /// Number of estimated deviations of parts, which come last in `globals.deviations`.
    #[must_use]
    pub fn deviation_count(&self) -> usize {
        let index = |p: &Parameter| match p.id {
            ParameterId::Deviation { deviation, .. } => Some(deviation + 1),
            _ => None,
        };
        self.parameters.iter().filter_map(index).max().unwrap_or(0)
    }

    /// Probability of a chi-square at least as large if model and noise are right.
    #[must_use]
    pub fn p_value(&self) -> Option<f64> {
        crate::statistics::chi_square_survival(self.chi2, self.degrees_of_freedom)
    }

    /// Standard deviation of the parameter at `index`; `None` if the data do not determine it.
    #[must_use]
    pub fn standard_deviation(&self, index: usize) -> Option<f64> {
        self.covariance.as_ref().map(|c| c[(index, index)].sqrt())
    }

    /// Correlation matrix, parameters x parameters, in the order of the covariance; `None` if the data do not
    /// determine the parameters.
    #[must_use]
    pub fn correlations(&self) -> Option<DMatrix<f64>> {
        let covariance = self.covariance.as_ref()?;
        let sd = covariance.diagonal().map(f64::sqrt);
        let n = sd.len();
        Some(DMatrix::from_fn(n, n, |i, k| {
            covariance[(i, k)] / (sd[i] * sd[k])
        }))
    }
}

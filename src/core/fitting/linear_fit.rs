//! Weighted linear least squares.

use nalgebra::{DMatrix, DVector};

use super::fit_statistics::FitStatistics;
use super::trust_region::Linearization;

/// Minimises `sum ((y_i - sum_k A_ik p_k) / sd_i)^2`.
///
/// `design` is `A` (one row per observation), `observations` the `y_i`, `sd` their standard deviations (`None`: all 1).
/// The columns are scaled to length one and factorised orthogonally, and the solution is improved once by a fit of its
/// residuals, so that about as many digits are lost as the condition number of the scaled columns has (Bjorck, *Numerical
/// Methods for Least Squares Problems*, section 2.9). Parameters that take part in an undetermined combination get
/// infinite standard deviations and are listed in `undetermined`.
///
/// # Panics
/// If the numbers of rows, observations and standard deviations differ, or a number is not finite.
#[must_use]
pub fn fit_linear(
    design: &DMatrix<f64>,
    observations: &[f64],
    sd: Option<&[f64]>,
) -> FitStatistics {
    assert_eq!(design.nrows(), observations.len(), "one row each");
    let mut weighted = design.clone();
    let mut right_hand_side = DVector::from_column_slice(observations);
    if let Some(sd) = sd {
        assert_eq!(sd.len(), observations.len(), "one sd each");
        for (k, sd) in sd.iter().enumerate() {
            weighted.row_mut(k).unscale_mut(*sd);
            right_hand_side[k] /= sd;
        }
    }
    let length = |norm: f64| if norm > 0.0 { norm } else { 1.0 };
    let scale = DVector::from_iterator(
        weighted.ncols(),
        weighted.column_iter().map(|column| length(column.norm())),
    );
    let factorised = Linearization::new(&weighted, &right_hand_side, &scale);
    let factorised = factorised.expect("finite numbers");
    let mut parameters = factorised.step(f64::INFINITY).change;
    let left = &right_hand_side - &weighted * &parameters;
    if let Some(of_left) = Linearization::new(&weighted, &left, &scale) {
        parameters += of_left.step(f64::INFINITY).change;
    }
    let square_sum = (&right_hand_side - &weighted * &parameters).norm_squared();
    let residuals = DVector::from_column_slice(observations) - design * &parameters;
    FitStatistics::new(
        parameters.as_slice().to_vec(),
        residuals.as_slice().to_vec(),
        square_sum,
        factorised.cofactor(),
        factorised.rank(),
    )
}

/// Fits the line `y = p_0 + p_1 x`; see [`fit_linear`].
///
/// ```
/// let fit = tautline_core::fitting::fit_line(&[0.0, 1.0, 2.0], &[1.0, 3.0, 5.0], None);
/// assert!((fit.parameters[0] - 1.0).abs() < 1e-14);
/// assert!((fit.parameters[1] - 2.0).abs() < 1e-14);
/// ```
///
/// # Panics
/// If the numbers of abscissae, observations and standard deviations differ, or a number is not finite.
#[must_use]
pub fn fit_line(x: &[f64], observations: &[f64], sd: Option<&[f64]>) -> FitStatistics {
    let design = DMatrix::from_fn(x.len(), 2, |row, k| if k == 0 { 1.0 } else { x[row] });
    fit_linear(&design, observations, sd)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weighted_mean_has_the_textbook_variance() {
        let design = DMatrix::from_element(3, 1, 1.0);
        let fit = fit_linear(&design, &[1.0, 2.0, 4.0], Some(&[1.0, 1.0, 2.0]));
        assert!((fit.parameters[0] - 4.0 / 2.25).abs() < 1e-15);
        assert!((fit.cofactor[(0, 0)] - 1.0 / 2.25).abs() < 1e-15);
        assert_eq!((fit.dof, fit.rank), (2, 1));
    }

    #[test]
    fn dependent_columns_are_reported() {
        let design = DMatrix::from_row_slice(4, 2, &[1.0, 3.0, 2.0, 6.0, 3.0, 9.0, 4.0, 12.0]);
        let fit = fit_linear(&design, &[1.0, 2.0, 3.0, 4.5], None);
        assert_eq!((fit.rank, fit.dof), (1, 3));
        // Only the sum of the first and three times the second matters.
        assert_eq!(fit.undetermined, [0, 1]);
        assert!(fit.standard_deviations.iter().all(|sd| sd.is_infinite()));
        assert!(!fit.is_full_rank());
    }

    #[test]
    fn without_redundancy_there_is_no_standard_deviation() {
        let fit = fit_line(&[0.0, 1.0], &[1.0, 3.0], None);
        let expected = [1.0, 2.0];
        assert!(
            fit.parameters
                .iter()
                .zip(expected)
                .all(|(p, e)| (p - e).abs() < 1e-15)
        );
        assert_eq!(fit.dof, 0);
        assert!(fit.standard_deviations[0].is_nan() && fit.residual_sd.is_nan());
    }
}

//! Weighted linear least squares.

use nalgebra::DMatrix;

use super::double_double::DoubleDouble;
use super::fit_statistics::FitStatistics;
use super::pivoted_qr::PivotedQr;

/// Minimises `sum ((y_i - sum_k A_ik p_k) / sd_i)^2`.
///
/// `design` is `A` (one row per observation), `observations` the `y_i`, `sd` their standard
/// deviations (`None`: all 1). The columns are scaled to length one and triangularised by
/// Householder reflections with pivoting in doubled precision, so that the result has all the digits
/// that the `f64` input determines (validated on the NIST StRD linear problems). A column that
/// depends on others to working precision gets parameter 0, an infinite standard deviation and an entry
/// in `undetermined`.
///
/// # Panics
/// If the numbers of rows, observations and standard deviations differ.
#[must_use]
pub fn fit_linear(
    design: &DMatrix<f64>,
    observations: &[f64],
    sd: Option<&[f64]>,
) -> FitStatistics {
    assert_eq!(design.nrows(), observations.len(), "one row each");
    let columns = (0..design.ncols())
        .map(|k| design.column(k).iter().map(|v| (*v).into()).collect())
        .collect();
    fit_columns(columns, observations, sd)
}

/// Fits `y = p_0 + p_1 x + .. + p_n x^n` with `n = degree`; see [`fit_linear`].
///
/// The powers are formed in doubled precision too: their rounding would cost a polynomial of degree ten
/// far from the origin (NIST Filip) half of its digits.
///
/// ```
/// let fit = tautline_core::fitting::fit_polynomial(&[0.0, 1.0, 2.0], &[1.0, 3.0, 5.0], None, 1);
/// assert!((fit.parameters[0] - 1.0).abs() < 1e-14);
/// assert!((fit.parameters[1] - 2.0).abs() < 1e-14);
/// ```
///
/// # Panics
/// If the numbers of abscissae, observations and standard deviations differ.
#[must_use]
pub fn fit_polynomial(
    x: &[f64],
    observations: &[f64],
    sd: Option<&[f64]>,
    degree: usize,
) -> FitStatistics {
    assert_eq!(x.len(), observations.len(), "one abscissa each");
    let mut columns = vec![vec![DoubleDouble::ONE; x.len()]];
    for k in 0..degree {
        let next = columns[k].iter().zip(x).map(|(p, x)| *p * (*x).into());
        columns.push(next.collect());
    }
    fit_columns(columns, observations, sd)
}

fn fit_columns(
    columns: Vec<Vec<DoubleDouble>>,
    observations: &[f64],
    sd: Option<&[f64]>,
) -> FitStatistics {
    let weights: Vec<DoubleDouble> = match sd {
        Some(sd) => {
            assert_eq!(sd.len(), observations.len(), "one sd each");
            let weight = |sd: &f64| DoubleDouble::ONE / DoubleDouble::from(*sd);
            sd.iter().map(weight).collect()
        }
        None => vec![DoubleDouble::ONE; observations.len()],
    };
    let weighted = |column: &[DoubleDouble]| -> Vec<DoubleDouble> {
        column.iter().zip(&weights).map(|(c, w)| *c * *w).collect()
    };
    let right_hand_side: Vec<DoubleDouble> = observations.iter().map(|y| (*y).into()).collect();
    let (scaled, scale) = scale_columns(columns.iter().map(|c| weighted(c)));

    // The input is rounded to f64, so a smaller remainder carries no information.
    let tolerance = f64::EPSILON * observations.len().max(columns.len()) as f64;
    let qr = PivotedQr::new(scaled, weighted(&right_hand_side), tolerance);
    let mut parameters = vec![DoubleDouble::ZERO; columns.len()];
    for (value, k) in qr.solve().into_iter().zip(&qr.order) {
        parameters[*k] = value / scale[*k];
    }

    let mut residuals = right_hand_side;
    for (column, parameter) in columns.iter().zip(&parameters) {
        for (e, a) in residuals.iter_mut().zip(column) {
            *e = *e - *a * *parameter;
        }
    }
    let weighted_residuals = weighted(&residuals);
    let square_sum = DoubleDouble::dot(&weighted_residuals, &weighted_residuals).to_f64();
    let to_f64 = |values: Vec<DoubleDouble>| values.into_iter().map(DoubleDouble::to_f64).collect();
    FitStatistics::new(
        to_f64(parameters),
        to_f64(residuals),
        square_sum,
        cofactor(&qr, &scale),
        qr.rank,
    )
}

/// Columns normalised to length one, and their original lengths (1 for a column of zeros).
fn scale_columns(
    columns: impl Iterator<Item = Vec<DoubleDouble>>,
) -> (Vec<Vec<DoubleDouble>>, Vec<DoubleDouble>) {
    columns
        .map(|mut column| {
            let mut length = DoubleDouble::dot(&column, &column).sqrt();
            if length == DoubleDouble::ZERO {
                length = DoubleDouble::ONE;
            }
            column.iter_mut().for_each(|v| *v = *v / length);
            (column, length)
        })
        .unzip()
}

/// `R^-1 R^-T` in the order and scale of the parameters; infinite where undetermined.
fn cofactor(qr: &PivotedQr, scale: &[DoubleDouble]) -> DMatrix<f64> {
    let count = scale.len();
    let mut cofactor = DMatrix::zeros(count, count);
    for k in &qr.order[qr.rank..] {
        cofactor[(*k, *k)] = f64::INFINITY;
    }
    let inverse = qr.inverse();
    for i in 0..qr.rank {
        for j in 0..qr.rank {
            let product = (0..qr.rank).fold(DoubleDouble::ZERO, |sum, k| {
                sum + inverse[k][i] * inverse[k][j]
            });
            let (row, column) = (qr.order[i], qr.order[j]);
            cofactor[(row, column)] = (product / (scale[row] * scale[column])).to_f64();
        }
    }
    cofactor
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
        assert_eq!((fit.rank, fit.dof, fit.undetermined.len()), (1, 3, 1));
        assert!(fit.standard_deviations[fit.undetermined[0]].is_infinite());
        assert!(!fit.is_full_rank());
    }

    #[test]
    fn without_redundancy_there_is_no_standard_deviation() {
        let fit = fit_polynomial(&[0.0, 1.0], &[1.0, 3.0], None, 1);
        assert_eq!(fit.parameters, [1.0, 2.0]);
        assert_eq!(fit.dof, 0);
        assert!(fit.standard_deviations[0].is_nan() && fit.residual_sd.is_nan());
    }
}

//! Numerical Jacobian of a prediction.

use nalgebra::DMatrix;

/// Step relative to the parameter: balances the truncation `h^4` of the formula with the rounding
/// `epsilon / h` for predictions that change by a factor e within some percent of a parameter.
const RELATIVE_STEP: f64 = 2e-4;

/// `J_ik = d f_i / d p_k` by the five-point central difference
/// `(8 (f(p + h) - f(p - h)) - (f(p + 2h) - f(p - 2h))) / 12 h` (Abramowitz, Stegun, 25.3.6).
pub(super) fn jacobian(
    predict: &dyn Fn(&[f64], &mut [f64]),
    parameters: &[f64],
    jacobian: &mut DMatrix<f64>,
) {
    let rows = jacobian.nrows();
    let mut point = parameters.to_vec();
    let mut value = vec![0.0; rows];
    for k in 0..parameters.len() {
        let mut column = vec![0.0; rows];
        let center = parameters[k];
        let step = RELATIVE_STEP * if center == 0.0 { 1.0 } else { center.abs() };
        for (multiple, weight) in [(2.0, -1.0), (1.0, 8.0), (-1.0, -8.0), (-2.0, 1.0)] {
            point[k] = center + multiple * step;
            predict(&point, &mut value);
            for (sum, value) in column.iter_mut().zip(&value) {
                *sum += weight * value / (12.0 * step);
            }
        }
        point[k] = center;
        jacobian.column_mut(k).copy_from_slice(&column);
    }
}

//! Mild model error that no cause explains: for the readings of each class a smooth function, part of the noise.
//!
//! The functions are polynomials of second and third degree of the position, waves over time and products with the
//! tension, orthonormal over the poses. What an effect of the catalogue expresses is taken out of them: constants,
//! linear functions of the pose, of the tension and of time, the square of the cable's length and so on. Their
//! coefficients have normal priors with one amplitude per class, in standard deviations of the readings as described.

use std::f64::consts::PI;

use nalgebra::{DMatrix, DVector};

use super::conditions::Conditions;
use super::reading_id::ReadingId;
use super::variables::Variables;
use crate::estimation::Linearisation;
use crate::measurement::Variable;

/// Readings for each function.
const READINGS_PER_FUNCTION: usize = 3;
/// Waves over the time of the measurement: half waves, from the first that is no drift.
const HALF_WAVES: std::ops::RangeInclusive<usize> = 2..=8;
/// Part of a function that must be left when the others are taken out.
const NEW: f64 = 0.05;

/// The functions of one class of readings.
pub(super) struct Shape {
    /// Their conditions, one function per column, of root mean square 1 together.
    pub columns: DMatrix<f64>,
}

/// The functions of every class; without columns where there are too few readings.
pub(super) fn shapes(
    conditions: &Conditions,
    linear: &Linearisation,
    variables: &Variables<'_>,
) -> Vec<Shape> {
    let of = |(class, id): (usize, &ReadingId)| {
        let poses = conditions.poses_of(class);
        let rows: Vec<usize> = poses.iter().map(|pose| linear.poses[*pose].row).collect();
        let found = functions(id, &rows, variables);
        let mut all = DMatrix::zeros(conditions.poses, found.len());
        let scale = (rows.len() as f64 / found.len().max(1) as f64).sqrt();
        for (column, function) in found.iter().enumerate() {
            for (pose, value) in poses.iter().zip(function.iter()) {
                all[(*pose, column)] = scale * value;
            }
        }
        Shape {
            columns: conditions.of_class(class, &all),
        }
    };
    conditions.classes.iter().enumerate().map(of).collect()
}

/// Orthonormal functions at rows of the measurements.
fn functions(id: &ReadingId, rows: &[usize], variables: &Variables<'_>) -> Vec<DVector<f64>> {
    let most = rows.len() / READINGS_PER_FUNCTION;
    let known = |variable: Variable| {
        let values = variables.values(id.quantity, id.cable, variable)?;
        let values = DVector::from_iterator(rows.len(), rows.iter().map(|row| values[*row]));
        let (low, high) = (values.min(), values.max());
        let varies = high - low > 0.0 && values.iter().all(|v| v.is_finite());
        varies.then(|| values.map(|v| 2.0 * (v - low) / (high - low) - 1.0))
    };
    let seconds = variables.values(id.quantity, id.cable, Variable::Time);
    let position: Vec<_> = (0..3).filter_map(|k| known(Variable::Position(k))).collect();
    let tension = known(Variable::Tension);
    let time = known(Variable::Time);
    let length = known(Variable::CableLength);
    let square = |v: &DVector<f64>| v.component_mul(v);

    let mut taken = vec![DVector::from_element(rows.len(), 1.0)];
    taken.extend(Variable::ALL.iter().filter_map(|v| known(*v)));
    taken.extend(length.iter().map(square));
    if let Some(seconds) = seconds.filter(|_| time.is_some()) {
        let of = |f: fn(f64) -> f64| DVector::from_iterator(rows.len(), rows.iter().map(|row| f(seconds[*row])));
        taken.push(of(|t| (t.max(0.0) / 600.0).ln_1p()));
        taken.push(of(|t| (-t.max(0.0) / 900.0).exp()));
    }
    let mut wanted = Vec::new();
    for (k, x) in position.iter().enumerate() {
        wanted.extend(position[..=k].iter().map(|y| x.component_mul(y)));
    }
    if let Some(time) = &time {
        wanted.extend(HALF_WAVES.map(|k| time.map(|t| (PI * k as f64 * (t + 1.0) / 2.0).cos())));
    }
    if let Some(tension) = &tension {
        wanted.push(square(tension));
        wanted.extend(position.iter().map(|x| x.component_mul(tension)));
    }
    for (k, x) in position.iter().enumerate() {
        for (i, y) in position[..=k].iter().enumerate() {
            let xy = x.component_mul(y);
            wanted.extend(position[..=i].iter().map(|z| xy.component_mul(z)));
        }
    }
    let mut basis: Vec<DVector<f64>> = Vec::new();
    for function in taken {
        basis.extend(beside(&basis, &function));
    }
    let first = basis.len();
    for function in wanted {
        if basis.len() < first + most && basis.len() < rows.len() {
            basis.extend(beside(&basis, &function));
        }
    }
    basis.split_off(first)
}

/// The part of a function across orthonormal ones, of norm 1; none where nothing is left.
fn beside(basis: &[DVector<f64>], function: &DVector<f64>) -> Option<DVector<f64>> {
    let norm = function.norm();
    let mut rest = function.clone();
    // Twice, against rounding.
    for _ in 0..2 {
        for known in basis {
            rest.axpy(-known.dot(&rest), known, 1.0);
        }
    }
    let left = rest.norm();
    (left > NEW * norm && norm > 0.0).then(|| rest / left)
}

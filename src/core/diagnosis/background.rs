//! Mild model error that no cause explains: for the readings of each class a smooth function, part of the noise.
//!
//! The functions are polynomials of second and third degree of the position, waves over time and products with the
//! tension, orthonormal over the poses. What an effect of the catalogue expresses is taken out of them: constants,
//! linear functions of the pose, of the tension and of time, the square of the cable's length and so on. But where there
//! is such an error it has constant and linear parts of the same size, which must not be taken for causes: they are
//! part of the noise, too, once the others show the error. The
//! coefficients have normal priors with one amplitude per class, in standard deviations of the readings as described.

use std::f64::consts::PI;

use nalgebra::{DMatrix, DVector};

use super::conditions::Conditions;
use super::reading_id::ReadingId;
use super::variables::Variables;
use crate::estimation::Linearisation;
use crate::measurement::Variable;

/// Readings for each function.
const READINGS_PER_FUNCTION: usize = 2;
/// Waves over the time of the measurement: half waves, from the first that is no drift.
const HALF_WAVES: std::ops::RangeInclusive<usize> = 2..=8;
/// Part of a function that must be left when the others are taken out.
const NEW: f64 = 0.05;

/// Degree of the polynomials of the position.
const DEGREE: usize = 5;
/// Size of the functions of tension and time over that of the position's of the same degree.
const BESIDE: f64 = 0.5;

/// The functions of one class of readings, in conditions, one per column.
pub(super) struct Shape {
    /// Those that no effect of the catalogue expresses, of root mean square 1 together.
    pub columns: DMatrix<f64>,
    /// Constants and linear functions of the same size: an error that is not a cause has them, too, but they show nothing.
    pub simple: DMatrix<f64>,
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
        let [simple, found] = functions(id, &rows, variables);
        let total: f64 = found.iter().map(|(_, size)| size * size).sum();
        let scale = (rows.len() as f64 / total.max(1.0)).sqrt();
        let spread = |functions: &[(DVector<f64>, f64)]| {
            let mut all = DMatrix::zeros(conditions.poses, functions.len());
            for (column, (function, size)) in functions.iter().enumerate() {
                for (pose, value) in poses.iter().zip(function.iter()) {
                    all[(*pose, column)] = scale * size * value;
                }
            }
            conditions.of_class(class, &all)
        };
        Shape {
            columns: spread(&found),
            simple: if found.is_empty() { spread(&[]) } else { spread(&simple) },
        }
    };
    conditions.classes.iter().enumerate().map(of).collect()
}

/// Functions with their sizes.
type Sized = Vec<(DVector<f64>, f64)>;

/// Orthonormal functions at rows of the measurements: those that effects express, and those that none does.
fn functions(id: &ReadingId, rows: &[usize], variables: &Variables<'_>) -> [Sized; 2] {
    let most = rows.len() / READINGS_PER_FUNCTION;
    let known = |variable: Variable| {
        let values = variables.values(id.quantity, id.cable, variable)?;
        let values = DVector::from_iterator(rows.len(), rows.iter().map(|row| values[*row]));
        let (low, high) = (values.min(), values.max());
        let varies = high - low > 0.0 && values.iter().all(|v| v.is_finite());
        varies.then(|| values.map(|v| 2.0 * (v - low) / (high - low) - 1.0))
    };
    let position: Vec<_> = (0..3).filter_map(|k| known(Variable::Position(k))).collect();
    let (tension, time) = (known(Variable::Tension), known(Variable::Time));
    let square = |v: &DVector<f64>| v.component_mul(v);

    let mut basis: Vec<DVector<f64>> = Vec::new();
    let mut simple: Sized = Vec::new();
    let constant = DVector::from_element(rows.len(), 1.0);
    for (function, size) in [(constant, 1.0)]
        .into_iter()
        .chain(position.iter().map(|x| (x.clone(), 1.0)))
        .chain(tension.iter().chain(&time).map(|v| (v.clone(), BESIDE)))
    {
        if let Some(new) = beside(&basis, &function) {
            basis.push(new.clone());
            simple.push((new, size));
        }
    }
    let mut expressed: Vec<_> = Variable::ALL.iter().filter_map(|v| known(*v)).collect();
    expressed.extend(known(Variable::CableLength).iter().map(square));
    if let Some(seconds) = variables.values(id.quantity, id.cable, Variable::Time) {
        let of = |f: fn(f64) -> f64| {
            let values = rows.iter().map(|row| f(seconds[*row].max(0.0)));
            DVector::from_iterator(rows.len(), values)
        };
        if time.is_some() {
            expressed.push(of(|t| (t / 600.0).ln_1p()));
            expressed.push(of(|t| (-t / 900.0).exp()));
        }
    }
    for function in expressed {
        basis.extend(beside(&basis, &function));
    }

    let mut wanted: Sized = Vec::new();
    // Monomials of one degree from those of the degree before, each with its last variable.
    let mut monomials: Vec<(DVector<f64>, usize)> =
        position.iter().enumerate().map(|(k, x)| (x.clone(), k)).collect();
    for degree in 2..=DEGREE {
        let more = monomials.iter().flat_map(|(m, last)| {
            (*last..position.len()).map(|k| (m.component_mul(&position[k]), k))
        });
        monomials = more.collect();
        let size = 2.0 / degree as f64;
        wanted.extend(monomials.iter().map(|(m, _)| (m.clone(), size)));
        if degree == 2 {
            wanted.extend(tension.iter().map(|t| (square(t), 1.0)));
            for time in &time {
                let wave = |k: usize| time.map(|t| (PI * k as f64 * (t + 1.0) / 2.0).cos());
                wanted.extend(HALF_WAVES.map(|k| (wave(k), BESIDE)));
            }
            let tension = tension.iter();
            let products = tension.flat_map(|t| position.iter().map(|x| x.component_mul(t)));
            wanted.extend(products.map(|p| (p, BESIDE)));
        }
    }
    let mut found: Sized = Vec::new();
    for (function, size) in wanted {
        if found.len() < most && basis.len() < rows.len()
            && let Some(new) = beside(&basis, &function) {
                basis.push(new.clone());
                found.push((new, size));
            }
    }
    [simple, found]
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

//! Mild model error that no cause explains: a smooth random function for the readings of each class, treated as noise.
//!
//! The functions are polynomials of the position from the second degree on, waves over time and products with the
//! tension, orthonormal over the poses. They are made orthogonal to whatever an effect of the catalogue can express:
//! constants, linear functions of pose, tension and time, the square of the cable length and so on. A real smooth error
//! also has constant and linear parts of the same size, which must not be mistaken for causes, so they become part of
//! the noise as soon as the other functions reveal the error. The coefficients have normal priors with one amplitude
//! per class, in standard deviations of the readings as described.

use std::f64::consts::PI;

use nalgebra::{DMatrix, DVector};

use super::budget::MIN_INDEPENDENT_PART;
use super::conditions::{Conditions, concatenate_columns};
use super::priors::{BACKGROUND_DEGREE, BACKGROUND_HALF_WAVES, READINGS_PER_BACKGROUND_FUNCTION};
use super::reading_id::ReadingId;
use super::variables::Variables;
use crate::estimation::Linearisation;
use crate::measurement::Variable;

/// The variables that a group of functions depends on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Group {
    Position,
    Time,
    /// Tension, alone and multiplied by the position.
    Load,
}

impl Group {
    const ALL: [Self; 3] = [Self::Position, Self::Time, Self::Load];
}

/// Background functions of one class of readings and one group, one per column.
pub(super) struct Shape {
    pub class: usize,
    pub group: Group,
    /// The functions that no effect of the catalogue expresses, one row per pose; their joint root mean square is 1.
    pub functions: DMatrix<f64>,
    /// Constant and linear functions of the same size. A smooth error contains them too, but they are no evidence of one.
    pub low_order: DMatrix<f64>,
}

impl Shape {
    /// All functions, one row per pose.
    pub fn all_functions(&self) -> DMatrix<f64> {
        concatenate_columns(&[&self.functions, &self.low_order])
    }
}

/// Builds the functions of every class and group, skipping those with too few readings. The shapes of one class are
/// adjacent.
pub(super) fn shapes(
    conditions: &Conditions,
    linear: &Linearisation,
    variables: &Variables<'_>,
) -> Vec<Shape> {
    let mut shapes = Vec::new();
    for (class, id) in conditions.classes.iter().enumerate() {
        let poses = conditions.poses_of(class);
        let rows: Vec<usize> = poses.iter().map(|pose| linear.poses[*pose].row).collect();
        let scaled_variables = ScaledVariables::new(id, &rows, variables);
        for group in Group::ALL {
            let Some([low_order, functions]) = scaled_variables.of_group(group) else {
                continue;
            };
            shapes.push(Shape {
                class,
                group,
                functions: at_all_poses(&functions, &poses, conditions.poses),
                low_order: at_all_poses(&low_order, &poses, conditions.poses),
            });
        }
    }
    shapes
}

/// Expands functions given at some poses, one row each, to all `count` poses; zero elsewhere.
pub(super) fn at_all_poses(
    functions: &DMatrix<f64>,
    poses: &[usize],
    count: usize,
) -> DMatrix<f64> {
    let mut expanded = DMatrix::zeros(count, functions.ncols());
    for (row, pose) in poses.iter().enumerate() {
        expanded.row_mut(*pose).copy_from(&functions.row(row));
    }
    expanded
}

/// Functions with the standard deviations of their coefficients.
type WeightedFunctions = Vec<(DVector<f64>, f64)>;

/// The variables on which the readings of one class may depend, each scaled to the interval from -1 to 1.
pub(super) struct ScaledVariables {
    count: usize,
    position: Vec<DVector<f64>>,
    rotation: Vec<DVector<f64>>,
    tension: Option<DVector<f64>>,
    time: Option<DVector<f64>>,
    /// Functions that effects of the catalogue express besides a constant, with the variable that they depend on.
    expressed: Vec<(Variable, DVector<f64>)>,
}

impl ScaledVariables {
    pub fn new(id: &ReadingId, rows: &[usize], variables: &Variables<'_>) -> Self {
        let vector = |value: &dyn Fn(usize) -> f64| {
            DVector::from_iterator(rows.len(), rows.iter().map(|row| value(*row)))
        };
        let scaled = |variable: Variable| {
            let values = variables.values(id.quantity, id.cable, variable)?;
            let values = vector(&|row| values[row]);
            let (low, high) = (values.min(), values.max());
            let varies = high - low > 0.0 && values.iter().all(|v| v.is_finite());
            varies.then(|| values.map(|v| 2.0 * (v - low) / (high - low) - 1.0))
        };
        let linear = Variable::ALL.iter().map(|v| (*v, scaled(*v)));
        let mut expressed: Vec<_> = linear.filter_map(|(v, f)| Some((v, f?))).collect();
        let length = Variable::CableLength;
        expressed.extend(scaled(length).map(|v| (length, v.component_mul(&v))));
        let time = scaled(Variable::Time);
        let seconds = variables.values(id.quantity, id.cable, Variable::Time);
        if let Some(seconds) = seconds.filter(|_| time.is_some()) {
            let creep = vector(&|row| (seconds[row].max(0.0) / 600.0).ln_1p());
            let settling = vector(&|row| (-seconds[row].max(0.0) / 900.0).exp());
            expressed.extend([creep, settling].map(|function| (Variable::Time, function)));
        }
        Self {
            count: rows.len(),
            position: (0..3)
                .filter_map(|k| scaled(Variable::Position(k)))
                .collect(),
            rotation: (0..3)
                .filter_map(|k| scaled(Variable::Rotation(k)))
                .collect(),
            tension: scaled(Variable::Tension),
            time,
            expressed,
        }
    }

    /// A constant and the functions of a variable that effects of the catalogue express.
    pub fn expressed(&self, variable: Variable) -> Vec<DVector<f64>> {
        let constant = DVector::from_element(self.count, 1.0);
        let functions = self.expressed.iter().filter(|(v, _)| *v == variable);
        let functions = functions.map(|(_, function)| function.clone());
        std::iter::once(constant).chain(functions).collect()
    }

    /// The functions of a group, one row per reading: those that effects express and those that none expresses. The
    /// latter have a joint root mean square of 1. `None` if there are none of them.
    fn of_group(&self, group: Group) -> Option<[DMatrix<f64>; 2]> {
        let [low_order, unexpressed] = self.functions(group);
        let total: f64 = unexpressed.iter().map(|(_, size)| size * size).sum();
        let scale = (self.count as f64 / total).sqrt();
        let sized = |set: &WeightedFunctions| {
            let columns: Vec<_> = set.iter().map(|(f, size)| f * (scale * size)).collect();
            DMatrix::from_columns(&columns)
        };
        (!unexpressed.is_empty()).then(|| [sized(&low_order), sized(&unexpressed)])
    }

    /// Orthonormal functions of a group: those that effects express, and those that none expresses.
    fn functions(&self, group: Group) -> [WeightedFunctions; 2] {
        let [linear, wanted] = match group {
            Group::Position => self.of_position(),
            Group::Time => self.of_time(),
            Group::Load => self.of_load(),
        };
        let mut basis: Vec<DVector<f64>> = Vec::new();
        let mut low_order: WeightedFunctions = Vec::new();
        if !wanted.is_empty() {
            let constant = (DVector::from_element(self.count, 1.0), 1.0);
            for (function, size) in std::iter::once(constant).chain(linear) {
                if let Some(new) = orthogonal_component(&basis, &function) {
                    basis.push(new.clone());
                    low_order.push((new, size));
                }
            }
        }
        let constant = DVector::from_element(self.count, 1.0);
        basis.extend(orthogonal_component(&basis, &constant));
        for (_, function) in &self.expressed {
            basis.extend(orthogonal_component(&basis, function));
        }
        let mut unexpressed: WeightedFunctions = Vec::new();
        for (function, size) in wanted {
            let has_room = unexpressed.len() < self.count / READINGS_PER_BACKGROUND_FUNCTION
                && basis.len() < self.count;
            if let Some(new) = orthogonal_component(&basis, &function).filter(|_| has_room) {
                basis.push(new.clone());
                unexpressed.push((new, size));
            }
        }
        [low_order, unexpressed]
    }

    fn of_position(&self) -> [WeightedFunctions; 2] {
        let position = &self.position;
        let mut wanted = Vec::new();
        // Each monomial of a degree is one of the previous degree times its last variable or a later one, so that none
        // occurs twice.
        let mut monomials: Vec<(DVector<f64>, usize)> = position
            .iter()
            .enumerate()
            .map(|(k, x)| (x.clone(), k))
            .collect();
        for degree in 2..=BACKGROUND_DEGREE {
            let more = monomials.iter().flat_map(|(m, last)| {
                (*last..position.len()).map(|k| (m.component_mul(&position[k]), k))
            });
            monomials = more.collect();
            let size = 2.0 / degree as f64;
            wanted.extend(monomials.iter().map(|(m, _)| (m.clone(), size)));
            if degree == 2 {
                wanted.extend(self.rotation.iter().map(|r| (r.component_mul(r), size)));
            }
        }
        [position.iter().map(|x| (x.clone(), 1.0)).collect(), wanted]
    }

    fn of_time(&self) -> [WeightedFunctions; 2] {
        let Some(time) = &self.time else {
            return [Vec::new(), Vec::new()];
        };
        let wave = |k: usize| time.map(|t| (PI * k as f64 * (t + 1.0) / 2.0).cos());
        let waves = BACKGROUND_HALF_WAVES.map(|k| (wave(k), 1.0));
        [vec![(time.clone(), 1.0)], waves.collect()]
    }

    fn of_load(&self) -> [WeightedFunctions; 2] {
        let Some(load) = &self.tension else {
            return [Vec::new(), Vec::new()];
        };
        let square = load.component_mul(load);
        let mut wanted = vec![(square.clone(), 1.0)];
        wanted.extend(self.position.iter().map(|x| (x.component_mul(load), 0.5)));
        wanted.push((square.component_mul(load), 0.5));
        [vec![(load.clone(), 1.0)], wanted]
    }
}

/// The normalised component of a function orthogonal to an orthonormal basis; `None` if it lies in the span of the
/// basis.
pub(super) fn orthogonal_component(
    basis: &[DVector<f64>],
    function: &DVector<f64>,
) -> Option<DVector<f64>> {
    let norm = function.norm();
    let mut rest = function.clone();
    // A second pass removes the rounding error of the first.
    for _ in 0..2 {
        for unit in basis {
            rest.axpy(-unit.dot(&rest), unit, 1.0);
        }
    }
    let remainder = rest.norm();
    (remainder > MIN_INDEPENDENT_PART * norm && norm > 0.0).then(|| rest / remainder)
}

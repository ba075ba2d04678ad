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
const READINGS_PER_FUNCTION: usize = 3;
/// Waves over the time of the measurement: half waves, from the first that is no drift.
const HALF_WAVES: std::ops::RangeInclusive<usize> = 2..=8;
/// Part of a function that must be left when the others are taken out.
const NEW: f64 = 0.05;

/// Degree of the polynomials of the position.
const DEGREE: usize = 5;
/// On what functions depend.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Group {
    /// On the position.
    Position,
    /// On time.
    Time,
    /// On the tension, alone and times the position.
    Load,
}

impl Group {
    const ALL: [Self; 3] = [Self::Position, Self::Time, Self::Load];
}

/// The functions of one class of readings and one group, in conditions, one per column.
pub(super) struct Shape {
    pub class: usize,
    pub group: Group,
    /// Those that no effect of the catalogue expresses, of root mean square 1 together.
    pub columns: DMatrix<f64>,
    /// The same as functions of the pose, one row per pose.
    pub functions: DMatrix<f64>,
    /// Constants and linear functions of the same size: an error that is not a cause has them, too, but they show nothing.
    pub simple: DMatrix<f64>,
}

/// The functions of every class, group after group; none where there are too few readings.
pub(super) fn shapes(
    conditions: &Conditions,
    linear: &Linearisation,
    variables: &Variables<'_>,
) -> Vec<Shape> {
    let mut shapes = Vec::new();
    for (class, id) in conditions.classes.iter().enumerate() {
        let poses = conditions.poses_of(class);
        let rows: Vec<usize> = poses.iter().map(|pose| linear.poses[*pose].row).collect();
        let circumstances = Circumstances::new(id, &rows, variables);
        for group in Group::ALL {
            let Some([simple, columns]) = circumstances.of_group(group) else {
                continue;
            };
            let functions = spread(&columns, &poses, conditions.poses);
            let simple = spread(&simple, &poses, conditions.poses);
            shapes.push(Shape {
                class,
                group,
                columns: conditions.of_class(class, &functions),
                functions,
                simple: conditions.of_class(class, &simple),
            });
        }
    }
    shapes
}

/// Functions of some poses, one row each, as functions of all `count`; zero elsewhere.
pub(super) fn spread(functions: &DMatrix<f64>, poses: &[usize], count: usize) -> DMatrix<f64> {
    let mut all = DMatrix::zeros(count, functions.ncols());
    for (row, pose) in poses.iter().enumerate() {
        all.row_mut(*pose).copy_from(&functions.row(row));
    }
    all
}

/// Functions with their sizes.
type Sized = Vec<(DVector<f64>, f64)>;

/// On what the readings of one class may depend, each from -1 to 1.
pub(super) struct Circumstances {
    count: usize,
    position: Vec<DVector<f64>>,
    rotation: Vec<DVector<f64>>,
    tension: Option<DVector<f64>>,
    time: Option<DVector<f64>>,
    /// What effects of the catalogue express beside a constant, and of which variable.
    expressed: Vec<(Variable, DVector<f64>)>,
}

impl Circumstances {
    pub fn new(id: &ReadingId, rows: &[usize], variables: &Variables<'_>) -> Self {
        let of = |value: &dyn Fn(usize) -> f64| {
            DVector::from_iterator(rows.len(), rows.iter().map(|row| value(*row)))
        };
        let known = |variable: Variable| {
            let values = variables.values(id.quantity, id.cable, variable)?;
            let values = of(&|row| values[row]);
            let (low, high) = (values.min(), values.max());
            let varies = high - low > 0.0 && values.iter().all(|v| v.is_finite());
            varies.then(|| values.map(|v| 2.0 * (v - low) / (high - low) - 1.0))
        };
        let linear = Variable::ALL.iter().map(|v| (*v, known(*v)));
        let mut expressed: Vec<_> = linear.filter_map(|(v, f)| Some((v, f?))).collect();
        let length = Variable::CableLength;
        expressed.extend(known(length).map(|v| (length, v.component_mul(&v))));
        let time = known(Variable::Time);
        let seconds = variables.values(id.quantity, id.cable, Variable::Time);
        if let Some(seconds) = seconds.filter(|_| time.is_some()) {
            let creep = of(&|row| (seconds[row].max(0.0) / 600.0).ln_1p());
            let settling = of(&|row| (-seconds[row].max(0.0) / 900.0).exp());
            expressed.extend([creep, settling].map(|function| (Variable::Time, function)));
        }
        Self {
            count: rows.len(),
            position: (0..3)
                .filter_map(|k| known(Variable::Position(k)))
                .collect(),
            rotation: (0..3)
                .filter_map(|k| known(Variable::Rotation(k)))
                .collect(),
            tension: known(Variable::Tension),
            time,
            expressed,
        }
    }

    /// The functions of a variable that effects of the catalogue express.
    pub fn expressed(&self, of: Variable) -> Vec<DVector<f64>> {
        let constant = DVector::from_element(self.count, 1.0);
        let own = self
            .expressed
            .iter()
            .filter(|(variable, _)| *variable == of);
        let own = own.map(|(_, function)| function.clone());
        std::iter::once(constant).chain(own).collect()
    }

    /// The functions of a group, one row per reading: those that effects express, and those that none does, these of root
    /// mean square 1 together; nothing where there are none.
    fn of_group(&self, group: Group) -> Option<[DMatrix<f64>; 2]> {
        let [simple, found] = self.functions(group);
        let total: f64 = found.iter().map(|(_, size)| size * size).sum();
        let scale = (self.count as f64 / total).sqrt();
        let sized = |all: &Sized| {
            let columns: Vec<_> = all.iter().map(|(f, size)| f * (scale * size)).collect();
            DMatrix::from_columns(&columns)
        };
        (!found.is_empty()).then(|| [sized(&simple), sized(&found)])
    }

    /// Orthonormal functions of a group: those that effects express, and those that none does.
    fn functions(&self, group: Group) -> [Sized; 2] {
        let [linear, wanted] = match group {
            Group::Position => self.of_position(),
            Group::Time => self.of_time(),
            Group::Load => self.of_load(),
        };
        let mut basis: Vec<DVector<f64>> = Vec::new();
        let mut simple: Sized = Vec::new();
        if !wanted.is_empty() {
            let constant = (DVector::from_element(self.count, 1.0), 1.0);
            for (function, size) in std::iter::once(constant).chain(linear) {
                if let Some(new) = beside(&basis, &function) {
                    basis.push(new.clone());
                    simple.push((new, size));
                }
            }
        }
        let constant = DVector::from_element(self.count, 1.0);
        basis.extend(beside(&basis, &constant));
        for (_, function) in &self.expressed {
            basis.extend(beside(&basis, function));
        }
        let mut found: Sized = Vec::new();
        for (function, size) in wanted {
            let has_room =
                found.len() < self.count / READINGS_PER_FUNCTION && basis.len() < self.count;
            if let Some(new) = beside(&basis, &function).filter(|_| has_room) {
                basis.push(new.clone());
                found.push((new, size));
            }
        }
        [simple, found]
    }

    fn of_position(&self) -> [Sized; 2] {
        let position = &self.position;
        let mut wanted = Vec::new();
        // Monomials of one degree from those of the degree before, each with its last variable.
        let mut monomials: Vec<(DVector<f64>, usize)> = position
            .iter()
            .enumerate()
            .map(|(k, x)| (x.clone(), k))
            .collect();
        for degree in 2..=DEGREE {
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

    fn of_time(&self) -> [Sized; 2] {
        let Some(time) = &self.time else {
            return [Vec::new(), Vec::new()];
        };
        let wave = |k: usize| time.map(|t| (PI * k as f64 * (t + 1.0) / 2.0).cos());
        let waves = HALF_WAVES.map(|k| (wave(k), 1.0));
        [vec![(time.clone(), 1.0)], waves.collect()]
    }

    fn of_load(&self) -> [Sized; 2] {
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

/// The part of a function across orthonormal ones, of norm 1; none where nothing is left.
pub(super) fn beside(basis: &[DVector<f64>], function: &DVector<f64>) -> Option<DVector<f64>> {
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

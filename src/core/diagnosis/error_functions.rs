//! Functions that model an unmodelled error of the readings.

use std::f64::consts::TAU;

use nalgebra::{DMatrix, DVector};

use super::Quantity;
use super::background::{ScaledVariables, at_all_poses, orthogonal_component};
use super::budget::{FREQUENCIES_PER_WAVE, MAX_INDUCING_POINTS, MAX_WAVES, NUGGET};
use super::discrepancy::smooth_functions;
use super::hyperparameters::LinearProblem;
use super::priors::{CORRELATION_LENGTHS, MAX_SMOOTH_FUNCTIONS, MIN_READINGS_OF_ERROR, MIN_WAVES};
use super::reading_id::ReadingId;
use super::report::ErrorForm;
use super::variables::Variables;
use crate::measurement::Variable;
use crate::robot::Robot;

/// Variables along which periodic errors are looked for.
const WAVE_VARIABLES: [Variable; 3] = [Variable::Revolutions, Variable::Time, Variable::Distance];

impl ErrorForm {
    /// Wording of the error in a sentence, after "have an error that".
    pub(super) fn description(self, robot: &Robot) -> String {
        match self {
            Self::Smooth(variable) => format!("depends on the {}", variable.name()),
            Self::Wave(Variable::Time, period) => format!("repeats every {period:.0} s"),
            Self::Wave(Variable::Distance, period) => {
                format!("repeats every {:.0} mm of distance", 1e3 * period)
            }
            Self::Wave(variable, period) => {
                format!("repeats every {period:.3} {}", variable.name())
            }
            Self::Crosstalk(cable) => {
                format!("depends on the tension of {}", robot.cables[cable].name)
            }
            Self::Position(_) => "depends on the position".to_owned(),
            Self::Orientation(_) => "depends on the orientation".to_owned(),
            Self::Scatter => "has no clear pattern".to_owned(),
        }
    }
}

/// Readings that may share an error: those of one kind and cable, or those of one kind on all cables.
pub(super) struct ErrorTarget {
    pub id: ReadingId,
    /// Standard deviation of the readings as described (SI units).
    pub sd: f64,
    pub classes: Vec<usize>,
    /// Poses at which there is such a reading.
    pub poses: Vec<usize>,
    pub families: Vec<FunctionFamily>,
}

/// The functions of one form for given readings.
pub(super) struct FunctionFamily {
    pub form: ErrorForm,
    /// The functions, one row per pose of the problem, and their part that no effect of the catalogue expresses.
    pub functions: DMatrix<f64>,
    pub unexpressed: DMatrix<f64>,
    pub log_prior: f64,
}

impl ErrorTarget {
    /// Builds all function families for some readings, with log priors that sum to a probability of 1; `None` if there
    /// are too few readings.
    pub fn new(
        (id, sd): (ReadingId, f64),
        classes: Vec<usize>,
        rows: &[usize],
        linear: &LinearProblem,
        variables: &Variables<'_>,
    ) -> Option<Self> {
        let poses = linear.conditions.poses_of(classes[0]);
        if poses.len() < MIN_READINGS_OF_ERROR {
            return None;
        }
        let own_rows: Vec<usize> = poses.iter().map(|pose| rows[*pose]).collect();
        let values_of = |cable: Option<usize>, variable: Variable| -> Option<Vec<f64>> {
            let values = variables.values(id.quantity, cable, variable)?;
            let values: Vec<f64> = own_rows.iter().map(|row| values[*row]).collect();
            values.iter().all(|v| v.is_finite()).then_some(values)
        };
        let values = |variable: Variable| values_of(id.cable, variable);
        let scaled_variables = ScaledVariables::new(&id, &own_rows, variables);
        let mut target = Self {
            id,
            sd,
            classes,
            poses,
            families: Vec::new(),
        };
        for variable in Variable::ALL {
            if let Some(values) = values(variable) {
                let most = MAX_SMOOTH_FUNCTIONS.min(values.len() / 4);
                let functions = smooth_functions(&values, variable, most);
                let expressed = scaled_variables.expressed(variable);
                target.push(
                    ErrorForm::Smooth(variable),
                    functions,
                    1,
                    (&expressed, linear),
                );
            }
        }
        for variable in WAVE_VARIABLES {
            let Some(values) = values(variable) else {
                continue;
            };
            let periods = periods(variable, &values);
            let expressed = scaled_variables.expressed(variable);
            for period in &periods {
                let functions = DMatrix::from_fn(values.len(), 2, |row, k| {
                    let angle = TAU * values[row] / period;
                    if k == 0 { angle.sin() } else { angle.cos() }
                });
                let form = ErrorForm::Wave(variable, *period);
                target.push(form, functions, periods.len(), (&expressed, linear));
            }
        }
        if id.quantity == Quantity::Tension && id.cable.is_some() {
            for cable in (0..linear.cables()).filter(|cable| Some(*cable) != id.cable) {
                if let Some(values) = values_of(Some(cable), Variable::Tension) {
                    let functions = smooth_functions(&values, Variable::Tension, 2);
                    target.push(ErrorForm::Crosstalk(cable), functions, 1, (&[], linear));
                }
            }
        }
        for length in CORRELATION_LENGTHS {
            let over = |variable: fn(usize) -> Variable| {
                let coordinates = (0..3).filter_map(|k| values(variable(k)).map(scaled));
                let expressed = (0..3).flat_map(|k| scaled_variables.expressed(variable(k)));
                (
                    field(&coordinates.collect::<Vec<_>>(), length),
                    expressed.collect::<Vec<_>>(),
                )
            };
            if let (Some(functions), expressed) = over(Variable::Position) {
                target.push(
                    ErrorForm::Position(length),
                    functions,
                    1,
                    (&expressed, linear),
                );
            }
            if let (Some(functions), expressed) = over(Variable::Rotation) {
                target.push(
                    ErrorForm::Orientation(length),
                    functions,
                    1,
                    (&expressed, linear),
                );
            }
        }
        let forms = target.families.len() as f64;
        let waves = target
            .families
            .iter()
            .filter(|f| matches!(f.form, ErrorForm::Wave(..)));
        let forms = forms - waves.count() as f64 + WAVE_VARIABLES.len() as f64;
        for family in &mut target.families {
            family.log_prior -= forms.ln();
        }
        Some(target)
    }

    fn push(
        &mut self,
        form: ErrorForm,
        functions: DMatrix<f64>,
        places: usize,
        (expressed, linear): (&[DVector<f64>], &LinearProblem),
    ) {
        let mut basis: Vec<DVector<f64>> = Vec::new();
        for function in expressed {
            basis.extend(orthogonal_component(&basis, function));
        }
        let mut unexpressed: Vec<DVector<f64>> = Vec::new();
        for function in functions.column_iter() {
            let function = function.into_owned();
            let Some(new) = orthogonal_component(&basis, &function) else {
                continue;
            };
            unexpressed.push(&new * new.dot(&function));
        }
        let unexpressed = if unexpressed.is_empty() {
            DMatrix::zeros(functions.nrows(), 0)
        } else {
            DMatrix::from_columns(&unexpressed)
        };
        self.families.push(FunctionFamily {
            form,
            functions: at_all_poses(&functions, &self.poses, linear.conditions.poses),
            unexpressed: at_all_poses(&unexpressed, &self.poses, linear.conditions.poses),
            log_prior: -(places as f64).ln(),
        });
    }
}

fn scaled(values: Vec<f64>) -> Vec<f64> {
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let scaled = values
        .into_iter()
        .map(|v| 2.0 * (v - low) / (high - low) - 1.0);
    scaled.collect()
}

/// Periods at which a wave is tried, with frequencies spaced closely enough that no wave falls between two. Times are
/// evenly spaced, so that the shortest resolvable period is twice the spacing.
fn periods(variable: Variable, values: &[f64]) -> Vec<f64> {
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let each = if variable == Variable::Time { 0.5 } else { 1.5 };
    let waves = MAX_WAVES.min(each * values.len() as f64);
    let steps =
        (MIN_WAVES * FREQUENCIES_PER_WAVE) as usize..=(waves * FREQUENCIES_PER_WAVE) as usize;
    let period = |step: usize| (high - low) * FREQUENCIES_PER_WAVE / step as f64;
    steps.map(period).collect()
}

/// A Gaussian field of variance 1 over some variables, one row per value: `K_xz L^-T` with the covariances `K_xz`
/// between all values and the inducing points, and `L L^T` the covariance of the inducing points. `None` without
/// variables.
pub(super) fn field(variables: &[Vec<f64>], length: f64) -> Option<DMatrix<f64>> {
    let count = variables.first()?.len();
    let points: Vec<usize> = (0..count)
        .step_by(count.div_ceil(MAX_INDUCING_POINTS))
        .collect();
    let covariance = |a: usize, b: usize| {
        let squares = variables.iter().map(|v| (v[a] - v[b]).powi(2));
        (-0.5 * squares.sum::<f64>() / (length * length)).exp()
    };
    let among = DMatrix::from_fn(points.len(), points.len(), |i, k| {
        covariance(points[i], points[k]) + if i == k { NUGGET } else { 0.0 }
    });
    let mut to = DMatrix::from_fn(points.len(), count, |i, k| covariance(points[i], k));
    among
        .cholesky()?
        .l_dirty()
        .solve_lower_triangular_mut(&mut to);
    Some(to.transpose())
}

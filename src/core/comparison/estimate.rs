//! Estimates of both runs with the priors removed that they share, and the deviations of parts common to both.

use nalgebra::{DMatrix, DVector};

use super::{ComparisonError, Identified};
use crate::estimation::{Parameter, ParameterId, covariance_of};
use crate::robot::Robot;

/// Fraction `k` of the shared priors that is removed.
const REMOVED_PRIOR: f64 = 0.99;

/// The estimates of one run.
pub(super) struct Estimate<'a> {
    pub run: Identified<'a>,
    /// `g`, in the order of the solution's parameters; home coordinates as deviations from the stated home pose.
    pub values: DVector<f64>,
    /// Index of each parameter in the system of both runs.
    joint: Vec<usize>,
}

impl<'a> Estimate<'a> {
    pub fn robot(&self) -> &'a Robot {
        &self.run.problem.dataset.robot
    }

    pub fn index_of(&self, id: &ParameterId) -> Option<usize> {
        let mut parameters = self.run.solution.parameters.iter();
        parameters.position(|parameter| parameter.id == *id)
    }

    /// Value of a parameter, or the stated value if the run does not estimate it.
    pub fn value_or(&self, id: &ParameterId, stated: f64) -> f64 {
        self.index_of(id).map_or(stated, |k| self.values[k])
    }
}

/// The estimates of both runs with their joint covariance.
pub(super) struct Estimates<'a> {
    pub runs: [Estimate<'a>; 2],
    covariance: DMatrix<f64>,
}

impl<'a> Estimates<'a> {
    /// # Errors
    /// If the data of a run do not determine all parameters.
    pub fn of(runs: [&Identified<'a>; 2]) -> Result<Self, ComparisonError> {
        let undetermined = |run| ComparisonError::Undetermined { run };
        let mut system = JointSystem::new();
        let [first, second] = runs;
        let first_indices = system.add(first).ok_or(undetermined("first"))?;
        let second_indices = system.add(second).ok_or(undetermined("second"))?;
        let covariance = covariance_of(&system.information).ok_or(undetermined("second"))?;
        let values = &covariance * &system.moment;
        let estimate = |run: &Identified<'a>, joint: Vec<usize>| Estimate {
            run: *run,
            values: values.select_rows(&joint),
            joint,
        };
        Ok(Self {
            runs: [
                estimate(first, first_indices),
                estimate(second, second_indices),
            ],
            covariance,
        })
    }

    /// Covariance of the differences of two parameters, each with its index in either run; a run that holds the parameter
    /// fixed has none.
    pub fn covariance_at(&self, one: [Option<usize>; 2], other: [Option<usize>; 2]) -> f64 {
        let signed = |places: [Option<usize>; 2]| {
            let runs = self.runs.iter().zip(places).zip([-1.0, 1.0]);
            runs.filter_map(|((run, place), sign)| Some((run.joint[place?], sign)))
        };
        let pairs = signed(one).flat_map(|(i, a)| signed(other).map(move |(k, b)| (i, k, a * b)));
        pairs
            .map(|(i, k, sign)| sign * self.covariance[(i, k)])
            .sum()
    }

    /// Covariance of the differences of two parameters.
    pub fn covariance_of(&self, one: &ParameterId, other: &ParameterId) -> f64 {
        let places = |id: &ParameterId| self.runs.each_ref().map(|run| run.index_of(id));
        self.covariance_at(places(one), places(other))
    }
}

/// Identity of a deviation's parameter across runs: the deviation, and the index of the parameter.
pub(crate) type DeviationKey = (&'static str, Vec<usize>, Vec<u64>, usize);

/// Normal equations of both runs: the information, and its product with the estimates.
struct JointSystem {
    information: DMatrix<f64>,
    moment: DVector<f64>,
    /// Index of each deviation that the runs estimate.
    deviations: Vec<(DeviationKey, usize)>,
}

impl JointSystem {
    fn new() -> Self {
        Self {
            information: DMatrix::zeros(0, 0),
            moment: DVector::zeros(0),
            deviations: Vec::new(),
        }
    }

    /// Adds a run and returns the indices of its parameters. `None` if its data do not determine them.
    fn add(&mut self, run: &Identified<'_>) -> Option<Vec<usize>> {
        run.solution.covariance.as_ref()?;
        let before = self.moment.len();
        let indices = self.indices(run);
        // The prior of a deviation is in the system already if the run before has it, too.
        let is_known = |k: usize| indices[k] < before;
        let (information, moment) = data_information(run, is_known);
        for (k, row) in indices.iter().enumerate() {
            self.moment[*row] += moment[k];
            for (l, column) in indices.iter().enumerate() {
                self.information[(*row, *column)] += information[(k, l)];
            }
        }
        covariance_of(&self.information)?;
        Some(indices)
    }

    /// Indices of the parameters of a run; those of deviations that the run before has are the same.
    fn indices(&mut self, run: &Identified<'_>) -> Vec<usize> {
        let mut count = self.moment.len();
        let mut indices = Vec::with_capacity(run.solution.parameters.len());
        for parameter in &run.solution.parameters {
            let key = deviation_key(run, &parameter.id);
            let mut known = self.deviations.iter();
            let known = known.find(|(other, _)| Some(other) == key.as_ref());
            indices.push(known.map_or(count, |(_, index)| *index));
            if known.is_none() {
                self.deviations.extend(key.map(|key| (key, count)));
                count += 1;
            }
        }
        self.information.resize_mut(count, count, 0.0);
        self.moment.resize_vertically_mut(count, 0.0);
        indices
    }
}

/// Information of a run on its parameters without the priors of the robot, and its product with the estimates. The prior of a
/// deviation is removed where `is_known` says so, by the index of the parameter.
pub(crate) fn data_information(
    run: &Identified<'_>,
    is_known: impl Fn(usize) -> bool,
) -> (DMatrix<f64>, DVector<f64>) {
    let parameters = &run.solution.parameters;
    let estimated = parameters.iter().map(|p| value_and_centre(run, p));
    let (values, centres): (Vec<f64>, Vec<f64>) = estimated.unzip();
    let mut information = run.solution.information.clone();
    let mut moment = &information * DVector::from_vec(values);
    for (k, parameter) in parameters.iter().enumerate() {
        let fraction = match &parameter.id {
            ParameterId::Deviation { .. } if is_known(k) => 1.0,
            id if is_shared(id) => REMOVED_PRIOR,
            _ => 0.0,
        };
        if let Some(sd) = parameter.prior_sd {
            let weight = fraction * sd.powi(-2);
            information[(k, k)] -= weight;
            moment[k] -= weight * centres[k];
        }
    }
    (information, moment)
}

/// `None` for a parameter that is no deviation.
pub(crate) fn deviation_key(run: &Identified<'_>, id: &ParameterId) -> Option<DeviationKey> {
    let ParameterId::Deviation {
        deviation,
        parameter,
    } = id
    else {
        return None;
    };
    let bound = &run.problem.deviations[*deviation].bound;
    // The two deviations of a wave differ by their phases.
    let values = bound.values.iter().map(|value| value.to_bits());
    let cables = bound.cables.clone();
    Some((bound.effect.id(), cables, values.collect(), *parameter))
}

/// Whether the prior of a parameter describes the robot, common to both runs, rather than one run. The prior of a deviation is
/// counted once, with the deviation itself.
fn is_shared(id: &ParameterId) -> bool {
    match id {
        ParameterId::EntryPoint { .. } | ParameterId::PlaneOffset | ParameterId::Effect { .. } => {
            true
        }
        ParameterId::Home(_) | ParameterId::HomeTension { .. } | ParameterId::Deviation { .. } => {
            false
        }
    }
}

/// Value at the solution and centre of its prior.
fn value_and_centre(run: &Identified<'_>, parameter: &Parameter) -> (f64, f64) {
    let globals = &run.solution.globals;
    let robot = &run.problem.dataset.robot;
    match parameter.id {
        ParameterId::EntryPoint { cable, axis } => (
            globals.entry_points[cable][axis],
            robot.cables[cable].pulley.entry_point_m[axis],
        ),
        ParameterId::PlaneOffset => (
            globals.plane_offset_m,
            robot.laser.map_or(0.0, |l| l.target_plane.offset_m),
        ),
        ParameterId::Home(coordinate) => {
            let stated = robot.home.map(|home| globals.home.difference(&home.pose()));
            (stated.map_or(0.0, |twist| twist[coordinate.index()]), 0.0)
        }
        ParameterId::HomeTension { cable } => (globals.home_tension_error_n[cable], 0.0),
        ParameterId::Effect { effect, parameter } => {
            let bound = &globals.effects[run.problem.held_effects.len() + effect];
            let neutral = bound.effect.parameters()[parameter].neutral;
            (bound.values[parameter], neutral)
        }
        ParameterId::Deviation {
            deviation,
            parameter,
        } => {
            let bound = &globals.deviations[run.problem.held_deviations.len() + deviation];
            let centre = &run.problem.deviations[deviation].bound;
            (bound.values[parameter], centre.values[parameter])
        }
    }
}

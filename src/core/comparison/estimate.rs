//! Estimates of one run with the priors removed that it shares with the other run.

use nalgebra::{DMatrix, DVector};

use super::Identified;
use crate::estimation::{Parameter, ParameterId, covariance_of};
use crate::robot::Robot;

/// Fraction `k` of the shared priors that is removed.
const REMOVED_PRIOR: f64 = 0.99;

/// Estimates of a run, free of the shared priors.
pub(super) struct Estimate<'a> {
    pub run: Identified<'a>,
    /// `g`, in the order of the solution's parameters; home coordinates as deviations from the stated home pose.
    pub values: DVector<f64>,
    /// `J^-1`.
    pub covariance: DMatrix<f64>,
}

impl<'a> Estimate<'a> {
    /// `None` where the data do not determine all parameters.
    pub fn of(run: &Identified<'a>) -> Option<Self> {
        let solution = run.solution;
        solution.covariance.as_ref()?;
        let count = solution.parameters.len();
        let mut information = solution.information.clone();
        let mut values = DVector::zeros(count);
        let mut pull = DVector::zeros(count);
        for (k, parameter) in solution.parameters.iter().enumerate() {
            let (value, centre) = value_and_centre(run, parameter);
            values[k] = value;
            if let (true, Some(sd)) = (is_shared(&parameter.id), parameter.prior_sd) {
                let weight = REMOVED_PRIOR * sd.powi(-2);
                information[(k, k)] -= weight;
                pull[k] = weight * (value - centre);
            }
        }
        let covariance = covariance_of(&information)?;
        Some(Self {
            run: *run,
            values: values + &covariance * pull,
            covariance,
        })
    }

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

    /// Covariance of two parameters; zero if either is held fixed.
    pub fn covariance_of(&self, one: &ParameterId, other: &ParameterId) -> f64 {
        match (self.index_of(one), self.index_of(other)) {
            (Some(i), Some(k)) => self.covariance[(i, k)],
            _ => 0.0,
        }
    }
}

/// Whether the prior of a parameter describes the robot, common to both runs, rather than the run.
fn is_shared(id: &ParameterId) -> bool {
    match id {
        ParameterId::EntryPoint { .. }
        | ParameterId::PlaneOffset
        | ParameterId::Effect { .. }
        | ParameterId::Deviation { .. } => true,
        ParameterId::Home(_) | ParameterId::HomeTension { .. } => false,
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

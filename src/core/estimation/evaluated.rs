//! A problem evaluated at given parameters and poses: the starting point of analysis and linearisation.

use super::distances::{DistanceState, Distances};
use super::evaluator::{Evaluator, Parts};
use super::globals::Globals;
use super::home::HomeRow;
use super::observation::ObservationKind;
use super::options::Division;
use super::parameter::Parameter;
use super::problem::Problem;
use super::solution::Solution;
use super::system::ColumnMap;
use crate::geometry::Pose;
use crate::real::Packet;

/// The evaluators of the poses and of the home row, and the map from columns to parameters.
pub(super) struct Evaluated<'a, T: Packet> {
    pub poses: Parts<'a, T>,
    /// Row and evaluator of the home pose, if revolutions are counted from it.
    pub home_evaluator: Option<(usize, Evaluator<'a, f64>)>,
    pub home: HomeRow,
    pub map: ColumnMap,
}

impl<'a, T: Packet> Evaluated<'a, T> {
    pub fn new(
        token: T::Token,
        problem: &'a Problem<'a>,
        globals: &Globals,
        parameters: &[Parameter],
        poses: (&[usize], &[Pose]),
        division: Division,
    ) -> Self {
        let home_row = problem.home_row();
        let evaluator = |row| (row, Evaluator::home((), problem, globals, row));
        let mut home_evaluator = home_row.map(evaluator);
        let home = match &mut home_evaluator {
            Some((_, evaluator)) => {
                HomeRow::evaluate(evaluator, problem, globals, parameters, None)
            }
            None => HomeRow::absolute(problem),
        };
        let mut poses = Parts::<T>::new(token, problem, globals, poses, division);
        poses.set_globals(globals, &home.lengths);
        Self {
            map: ColumnMap::new(problem, parameters, poses.layout()),
            poses,
            home_evaluator,
            home,
        }
    }

    /// Evaluates `problem` at a solution, with all details.
    pub fn at(
        token: T::Token,
        problem: &'a Problem<'a>,
        solution: &Solution,
        division: Division,
    ) -> Self {
        let fitted = &solution.poses[usize::from(problem.home_row().is_some())..];
        let (rows, poses): (Vec<usize>, Vec<Pose>) = fitted.iter().copied().unzip();
        let (globals, parameters) = (&solution.globals, &solution.parameters);
        let mut evaluated = Self::new(
            token,
            problem,
            globals,
            parameters,
            (&rows, &poses),
            division,
        );
        evaluated.poses.set_detailed();
        evaluated
    }

    /// The distances, with the poses eliminated where they are.
    pub fn distances(
        &mut self,
        problem: &Problem<'_>,
        (globals, parameters): (&Globals, &[Parameter]),
    ) -> Option<Distances> {
        if !problem.has_distances() {
            return None;
        }
        self.poses.find_tensions();
        self.poses.assemble(None, 0.0);
        let state = DistanceState {
            problem,
            globals,
            parameters,
            map: &self.map,
            home: &self.home,
            huber: None,
        };
        Distances::evaluate(&state, &self.poses)
    }
}

/// Standard deviation of a reading in a row packed by `evaluator` (SI units).
pub(super) fn sd_of<T: Packet>(
    problem: &Problem<'_>,
    evaluator: &Evaluator<'_, T>,
    kind: ObservationKind,
    row: usize,
) -> f64 {
    let robot = &problem.dataset.robot;
    match kind {
        ObservationKind::Length(cable) => evaluator.length_sd(cable),
        ObservationKind::Tension(cable) => evaluator.tension_sd(cable),
        ObservationKind::Equilibrium(axis) => evaluator.wrench_variance(axis.index()).sqrt(),
        ObservationKind::Laser => robot.laser.map_or(f64::NAN, |l| l.sd_m),
        ObservationKind::Swivel(cable) => {
            robot.cables[cable].pulley.swivel_sd_rad.unwrap_or(f64::NAN)
        }
        ObservationKind::TrackerPosition(k) => {
            let own = problem.dataset.measurements.tracked_position_sd_m.get(row);
            let nominal = robot
                .tracker
                .map_or(f64::NAN, |t| t.position_sd_m.each()[k]);
            own.map(|sd| sd[k])
                .filter(|sd| !sd.is_nan())
                .unwrap_or(nominal)
        }
        ObservationKind::TrackerOrientation(_) => robot
            .tracker
            .and_then(|t| t.orientation_sd_rad)
            .unwrap_or(f64::NAN),
        ObservationKind::Inclination(_) => robot.inclinometer.map_or(f64::NAN, |i| i.sd_rad),
        ObservationKind::Distance(k) => problem.dataset.measurements.distances[k].sd_m,
    }
}

/// Whether a force sensor with noise of its own reads the tension of a cable at a row.
pub(super) fn is_tension_read<T: Packet>(
    problem: &Problem<'_>,
    evaluator: &Evaluator<'_, T>,
    (row, cable): (usize, usize),
) -> bool {
    let force = problem.dataset.measurements.force_n.get(row, cable);
    problem.has_latent_tension() && !force.is_nan() && evaluator.tension_sd(cable) > 0.0
}

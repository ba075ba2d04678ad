//! Levenberg-Marquardt on the common parameters, with the poses eliminated.
//!
//! Every pass over the poses moves them by the step just found and accumulates the equations at the new
//! poses, so that an accepted step costs one pass.

use pulp::{Arch, Simd, WithSimd};

use super::EstimationError;
use super::distances::{DistanceState, Distances};
use super::evaluator::{Evaluator, Parts};
use super::globals::Globals;
use super::home::{HomeRow, direct_column};
use super::options::{Control, Division, Options, Progress, Termination};
use super::parameter::{Parameter, ParameterId};
use super::problem::{Loss, Method, Poses, Problem};
use super::solution::Solution;
use super::start::{Start, is_local_minimum};
use super::surface::outside_surface;
use super::system::{ColumnMap, Priors, System};
use crate::real::{Lanes, Packet};
use crate::tolerances::PERFECT_FIT;

/// Solves an estimation problem from the nominal values, or from a known solution.
///
/// The observer sees every step and can cancel, in which case the present state is returned.
///
/// ```
/// use tautline_core::estimation::{Control, Options, Problem, solve};
/// use tautline_core::robot::presets;
/// use tautline_core::simulation::{SimulationOptions, simulate};
///
/// let planar = presets::find("planar").unwrap();
/// let options = SimulationOptions {
///     workspace: Some(planar.workspace),
///     tension: Some(planar.tension),
///     ..SimulationOptions::new(20, 1)
/// };
/// let run = simulate(&planar.robot, &options)?;
///
/// let problem = Problem::new(&run.dataset)?;
/// let solution = solve(&problem, &Options::default(), &mut |_| Control::Continue)?;
/// assert!(solution.converged());
/// assert!(solution.p_value().unwrap() > 1e-3, "the model explains its own data");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// If the measurements cannot be used with this robot, or no reading depends on a free effect.
/// Non-convergence is not an error.
pub fn solve(
    problem: &Problem<'_>,
    options: &Options,
    observer: &mut dyn FnMut(&Progress) -> Control,
) -> Result<Solution, EstimationError> {
    check(problem)?;
    Arch::new().dispatch(Dispatch {
        problem,
        options,
        observer,
    })
}

fn check(problem: &Problem<'_>) -> Result<(), EstimationError> {
    let data = &problem.dataset.measurements;
    let robot = &problem.dataset.robot;
    if data.revolutions.is_empty() && data.length_m.is_empty() {
        return Err(EstimationError::NoLengths);
    }
    if problem.pose_rows().is_empty() {
        return Err(EstimationError::NoPoses);
    }
    if data.revolutions.is_empty() {
        return Ok(());
    }
    if robot.home.is_none() {
        return Err(EstimationError::NoHome);
    }
    let row = problem.home_row().ok_or(EstimationError::NoHomeRow)?;
    for (index, cable) in robot.cables.iter().enumerate() {
        let reads = cable.force_sensor.is_some() && !data.force_n.is_empty();
        if reads && data.force_n.get(row, index).is_nan() {
            return Err(EstimationError::NoHomeTension(cable.name.clone()));
        }
    }
    Ok(())
}

struct Dispatch<'p, 'o> {
    problem: &'p Problem<'p>,
    options: &'o Options,
    observer: &'o mut dyn FnMut(&Progress) -> Control,
}

impl WithSimd for Dispatch<'_, '_> {
    type Output = Result<Solution, EstimationError>;
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let problem = self.problem;
        let division = self.options.division;
        let from =
            |start: Start<'_>| LevenbergMarquardt::<Lanes<S>>::new(simd, problem, start, division);
        let start = from(Start::of(problem, self.options));
        start.check_effects()?;
        let first = start.run(self.options, self.observer);
        if !is_local_minimum(problem, &first, self.options) {
            return Ok(first);
        }
        // The given poses have led to a local minimum: start again from those that follow from the lengths.
        let second = from(Start::Lengths).run(self.options, self.observer);
        let better = second.chi2 < first.chi2 || first.chi2.is_nan();
        Ok(if better || second.termination == Termination::Cancelled {
            second
        } else {
            first
        })
    }
}

/// State of the solver.
pub(super) struct LevenbergMarquardt<'a, T: Packet> {
    problem: &'a Problem<'a>,
    parameters: Vec<Parameter>,
    map: ColumnMap,
    huber: Option<f64>,
    globals: Globals,
    poses: Parts<'a, T>,
    home_evaluator: Option<Evaluator<'a, f64>>,
    home: HomeRow,
    priors: Priors,
    distances: Option<Distances>,
    /// Whether the solve started at a known solution.
    is_continued: bool,
}

impl<'a, T: Packet> LevenbergMarquardt<'a, T> {
    pub(super) fn new(
        token: T::Token,
        problem: &'a Problem<'a>,
        start: Start<'_>,
        division: Division,
    ) -> Self {
        let globals = start.globals(problem);
        let parameters = problem.parameters();
        let rows = problem.pose_rows();
        let poses = start.poses(problem, &globals, &rows);
        let poses = Parts::<T>::new(token, problem, &globals, (&rows, &poses), division);
        let counts_from_home = !problem.dataset.measurements.revolutions.is_empty();
        let home_evaluator = problem
            .home_row()
            .filter(|_| counts_from_home)
            .map(|row| Evaluator::home((), problem, &globals, row));
        let mut solver = Self {
            problem,
            map: ColumnMap::new(problem, &parameters, poses.layout()),
            huber: match problem.loss {
                Loss::Square => None,
                Loss::Huber(limit) => Some(limit),
            },
            priors: Priors::evaluate(problem, &globals, &parameters),
            home: HomeRow::absolute(problem),
            parameters,
            globals,
            poses,
            home_evaluator,
            distances: None,
            is_continued: matches!(start, Start::Known(_)),
        };
        solver.evaluate_home();
        if solver.is_continued {
            solver.poses.find_tensions();
        }
        solver.assemble(0.0);
        solver
    }

    /// Rejects free effects that no reading depends on, on any of their cables.
    fn check_effects(&self) -> Result<(), EstimationError> {
        let free = &self.problem.free_effects;
        let (mut visible, mut invisible) = (Vec::new(), Vec::new());
        for (index, parameter) in self.parameters.iter().enumerate() {
            if let ParameterId::Effect { effect, .. } = parameter.id {
                let id = free[effect].effect.id();
                let depends = self.depends_on(index);
                if depends {
                    &mut visible
                } else {
                    &mut invisible
                }
                .push(id);
            }
        }
        match invisible.into_iter().find(|id| !visible.contains(id)) {
            Some(id) => Err(EstimationError::Unobservable(id.to_owned())),
            None => Ok(()),
        }
    }

    /// Whether any reading depends on a parameter.
    fn depends_on(&self, parameter: usize) -> bool {
        let (sums, layout, home) = (self.poses.sums(), self.poses.layout(), &self.home);
        let column = direct_column(&self.parameters[parameter].id, layout, self.problem);
        let at_poses = column.is_some_and(|column| sums.concerns(column));
        let rows = home.gradients.chunks_exact(self.parameters.len());
        let at_home = rows.into_iter().any(|row| row[parameter] != 0.0);
        let moves_length = |cable: usize| {
            let mut terms = home.length_gradients[cable].iter();
            terms.any(|(k, _)| *k == parameter) && sums.concerns(layout.home_length_column(cable))
        };
        let in_distances = |all: &Distances| all.design.column(parameter).amax() > 0.0;
        let at_distances = self.distances.as_ref().is_some_and(in_distances);
        at_poses || at_home || at_distances || (0..layout.cables).any(moves_length)
    }

    fn evaluate_home(&mut self) {
        if let Some(evaluator) = &mut self.home_evaluator {
            self.home = HomeRow::evaluate(
                evaluator,
                self.problem,
                &self.globals,
                &self.parameters,
                self.huber,
            );
        }
        self.priors = Priors::evaluate(self.problem, &self.globals, &self.parameters);
        self.poses.set_globals(&self.globals, &self.home.lengths);
    }

    /// Moves the poses by the step taken last and accumulates the normal equations there.
    fn assemble(&mut self, damping: f64) {
        self.poses.assemble(self.huber, damping);
        let state = DistanceState {
            problem: self.problem,
            globals: &self.globals,
            parameters: &self.parameters,
            map: &self.map,
            home: &self.home,
            huber: self.huber,
        };
        self.distances = Distances::evaluate(&state, &self.poses);
    }

    fn loss(&self) -> f64 {
        let distances = self.distances.as_ref().map_or(0.0, |all| all.loss);
        self.poses.sums().loss + self.home.loss + self.priors.loss + distances
    }

    fn system(&self) -> System {
        let mut system = System::build(self.poses.sums(), &self.map, &self.home, &self.priors);
        if let Some(distances) = &self.distances {
            system.add_distances(distances);
        }
        system
    }

    /// Reduction of the loss that steps of the poses alone predict.
    fn reduction_by_poses(&self) -> f64 {
        let distances = self.distances.as_ref();
        self.poses.sums().predicted_reduction
            + distances.map_or(0.0, Distances::predicted_reduction)
    }

    /// The step of the columns from one of the parameters; poses that distances connect are prepared for theirs.
    fn column_step(&mut self, step: &[f64]) -> Vec<f64> {
        for (pose, pull) in self.distances.iter().flat_map(|all| all.pulls(step)) {
            self.poses.add_to_residual(pose, &pull);
        }
        self.map.column_step(&self.home, step)
    }

    pub(super) fn run(
        mut self,
        options: &Options,
        observer: &mut dyn FnMut(&Progress) -> Control,
    ) -> Solution {
        let mut search = SearchState {
            unsettled: if self.is_continued {
                options.settling_passes
            } else {
                0
            },
            ..SearchState::default()
        };
        let termination = loop {
            if let Some(end) = self.iterate(&mut search, options, observer) {
                break end;
            }
        };
        self.finish(&search, termination)
    }

    /// Attempts one step; returns the reason to end, if there is one.
    fn iterate(
        &mut self,
        search: &mut SearchState,
        options: &Options,
        observer: &mut dyn FnMut(&Progress) -> Control,
    ) -> Option<Termination> {
        let loss = self.loss();
        if !loss.is_finite() || search.damping > options.most_damping {
            return Some(Termination::Stalled);
        }
        let Some((step, predicted)) = self.system().step(search.damping) else {
            self.damp(search, options.raised(search.damping));
            return None;
        };
        let predicted = predicted + self.reduction_by_poses();
        let negligible = match self.problem.method {
            Method::Joint => options.negligible,
            Method::Simple => 0.0,
        };
        let enough = options.tolerance * loss + negligible.max(PERFECT_FIT);
        if predicted <= enough {
            // Strong damping makes every predicted reduction small, which alone is not convergence.
            if search.damping <= options.first_damping {
                return self.settle(search);
            }
            if search.rejected {
                return Some(Termination::Stalled);
            }
            self.damp(search, options.lowered(search.damping));
            return None;
        }
        if search.unsettled == 0 && search.remaining_after(predicted) <= enough {
            self.take_last_step(step.as_slice(), predicted, search);
            return Some(Termination::Converged);
        }
        if search.iterations == options.max_iterations {
            return Some(Termination::IterationLimit);
        }
        let progress = Progress {
            iteration: search.iterations,
            loss,
            predicted_reduction: predicted,
            damping: search.damping,
        };
        if observer(&progress) == Control::Cancel {
            return Some(Termination::Cancelled);
        }
        self.try_step(step.as_slice(), predicted, search, options);
        None
    }

    /// Relinearises at the present state with another damping.
    fn damp(&mut self, search: &mut SearchState, damping: f64) {
        search.damping = damping;
        search.reduction_before = None;
        self.assemble(damping);
    }

    /// Ends once the tensions at which the equilibrium is linearised have settled; each pass brings them closer.
    fn settle(&mut self, search: &mut SearchState) -> Option<Termination> {
        if search.unsettled == 0 {
            return Some(Termination::Converged);
        }
        search.unsettled -= 1;
        self.damp(search, search.damping);
        None
    }

    /// Takes a step if it lowers the loss; otherwise restores the state and raises the damping.
    fn try_step(
        &mut self,
        step: &[f64],
        predicted: f64,
        search: &mut SearchState,
        options: &Options,
    ) {
        let accepted_increase = match self.problem.method {
            Method::Joint => options.accepted_increase,
            Method::Simple => 0.0,
        };
        let loss = self.loss();
        let before = (self.globals.clone(), self.home.clone(), self.priors.clone());
        // The poses move first, because their step belongs to the parameters at which they were eliminated.
        let columns = self.column_step(step);
        self.poses.take_step(&columns);
        self.globals.step(self.problem, &self.parameters, step);
        self.evaluate_home();
        let next = options.lowered(search.damping);
        self.assemble(next);
        if self.loss() <= loss * (1.0 + accepted_increase) {
            search.reduction_before = (search.damping == 0.0).then_some(predicted);
            search.damping = next;
            search.iterations += 1;
            search.unsettled = search.unsettled.saturating_sub(1);
            search.rejected = false;
            return;
        }
        (self.globals, self.home, self.priors) = before;
        self.poses.undo_step();
        self.poses.set_globals(&self.globals, &self.home.lengths);
        search.rejected = true;
        self.damp(search, options.raised(search.damping));
    }

    /// Takes a step whose outcome is predicted well enough that it need not be evaluated.
    fn take_last_step(&mut self, step: &[f64], predicted: f64, search: &mut SearchState) {
        let columns = self.column_step(step);
        self.globals.step(self.problem, &self.parameters, step);
        self.poses.move_poses(&columns);
        search.unevaluated = predicted;
        search.iterations += 1;
    }

    /// Number of equations that assumed tensions satisfy by themselves: those of the equilibrium.
    fn assumed(&self) -> f64 {
        if !self.problem.assumes_tensions() {
            return 0.0;
        }
        let rows = self.poses.len() + usize::from(self.home_evaluator.is_some());
        (self.problem.dataset.robot.platform.freedom().count() * rows) as f64
    }

    fn finish(mut self, search: &SearchState, termination: Termination) -> Solution {
        if search.damping != 0.0 {
            self.assemble(0.0);
        }
        let chi2 = (self.loss() - search.unevaluated).max(0.0);
        let system = self.system();
        let priors = self
            .parameters
            .iter()
            .filter(|p| p.prior_sd.is_some())
            .count();
        let distances = self.distances.as_ref().map_or(0, Distances::count);
        let observations = self.poses.sums().readings + self.home.readings - self.assumed()
            + (priors + distances) as f64;
        let unknowns = self.poses.sums().coordinates + self.parameters.len() as f64;
        let free = match self.problem.poses {
            Poses::Estimated => self.problem.dataset.robot.platform.freedom().count(),
            Poses::HeldAtTracker => 0,
        };
        let all = free * self.poses.len();
        let home = self
            .home_evaluator
            .as_ref()
            .map(|e| (e.rows()[0], self.globals.home));
        let poses: Vec<_> = home.into_iter().chain(self.poses.poses()).collect();
        let mut tensions_n = self.poses.tensions(self.problem.dataset.measurements.len());
        if let Some(evaluator) = &self.home_evaluator {
            evaluator.write_tensions(&mut tensions_n);
        }
        Solution {
            tensions_n,
            outside_surface: outside_surface(self.problem, &self.globals, &poses),
            poses,
            covariance: system.covariance(),
            information: system.information,
            parameters: self.parameters,
            globals: self.globals,
            termination,
            iterations: search.iterations,
            chi2,
            degrees_of_freedom: observations - unknowns,
            undetermined_coordinates: all - self.poses.sums().coordinates as usize,
        }
    }
}

/// State of the iteration except the parameters.
#[derive(Debug, Default)]
struct SearchState {
    damping: f64,
    iterations: usize,
    /// Whether the last step from the present state was rejected.
    rejected: bool,
    /// Predicted reduction of the previous step, if it was undamped and taken.
    reduction_before: Option<f64>,
    /// Remaining passes until the latent tensions have settled.
    unsettled: usize,
    /// Predicted reduction of the last step, if it was taken without evaluation.
    unevaluated: f64,
}

impl SearchState {
    /// Loss that the steps after one with this predicted reduction would still remove, extrapolated from the rate at which
    /// predicted reductions shrink; infinite after a damped step.
    fn remaining_after(&self, predicted: f64) -> f64 {
        let before = match self.reduction_before {
            Some(before) if self.damping == 0.0 => before,
            _ => return f64::INFINITY,
        };
        let rate = predicted / before;
        if rate < 0.5 {
            predicted * rate / (1.0 - rate)
        } else {
            f64::INFINITY
        }
    }
}

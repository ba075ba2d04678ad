//! Levenberg-Marquardt on the common parameters, with the poses eliminated.
//!
//! Every pass over the poses moves them by the step just found and sums up the equations at the new
//! poses, so that an accepted step costs one pass.

use pulp::{Arch, Simd, WithSimd};

use super::EstimationError;
use super::evaluator::Evaluator;
use super::home::HomeRow;
use super::options::{Control, Options, Progress, Termination};
use super::parameter::Parameter;
use super::problem::{Globals, Loss, Method, Poses, Problem};
use super::solution::Solution;
use super::start::{Start, is_lost, start_poses};
use super::surface::outside_surface;
use super::system::{ColumnMap, Priors, System};
use crate::real::{Lanes, Packet};

/// Damping to start with when an undamped step fails.
const FIRST_DAMPING: f64 = 1e-4;
/// Damping below which steps are taken undamped.
const LEAST_DAMPING: f64 = 1e-7;
/// Damping at which the solver gives up.
const MOST_DAMPING: f64 = 1e12;

/// Solves an estimation problem from the nominal values.
///
/// # Errors
/// If the measurements cannot be used with this robot at all. Non-convergence is no error.
pub fn solve(
    problem: &Problem<'_>,
    options: &Options,
    observer: &mut dyn FnMut(&Progress) -> Control,
) -> Result<Solution, EstimationError> {
    check(problem)?;
    Ok(Arch::new().dispatch(Dispatch {
        problem,
        options,
        observer,
    }))
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
    type Output = Solution;
    fn with_simd<S: Simd>(self, simd: S) -> Solution {
        let problem = self.problem;
        let from = |start: Start| Descent::<Lanes<S>>::from(simd, problem, start);
        let first = from(Start::Given).run(self.options, self.observer);
        if !is_lost(problem, &first) {
            return first;
        }
        // The given poses have led nowhere: try those that the lengths themselves tell.
        let second = from(Start::Lengths).run(self.options, self.observer);
        let better = second.chi2 < first.chi2 || first.chi2.is_nan();
        if better || second.termination == Termination::Cancelled {
            second
        } else {
            first
        }
    }
}

/// Everything that an iteration changes.
pub(super) struct Descent<'a, T: Packet> {
    problem: &'a Problem<'a>,
    parameters: Vec<Parameter>,
    map: ColumnMap,
    huber: Option<f64>,
    globals: Globals,
    poses: Evaluator<'a, T>,
    home_evaluator: Option<Evaluator<'a, f64>>,
    home: HomeRow,
    priors: Priors,
}

impl<'a, T: Packet> Descent<'a, T> {
    pub(super) fn from(token: T::Token, problem: &'a Problem<'a>, start: Start) -> Self {
        let globals = Globals::nominal(problem);
        let parameters = problem.parameters();
        let rows = problem.pose_rows();
        let start = start_poses(problem, &globals, &rows, start);
        let poses = Evaluator::<T>::new(token, problem, &globals, rows, &start);
        let counts_from_home = !problem.dataset.measurements.revolutions.is_empty();
        let home_evaluator = problem
            .home_row()
            .filter(|_| counts_from_home)
            .map(|row| Evaluator::home((), problem, &globals, row));
        let mut descent = Self {
            problem,
            map: ColumnMap::new(problem, &parameters, &poses.layout),
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
        };
        descent.evaluate_home();
        descent
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
        self.poses
            .set_globals(&self.globals, Some(&self.home.lengths));
    }

    fn loss(&self) -> f64 {
        self.poses.sums.loss + self.home.loss + self.priors.loss
    }

    fn system(&self) -> System {
        System::build(&self.poses.sums, &self.map, &self.home, &self.priors)
    }

    pub(super) fn run(
        mut self,
        options: &Options,
        observer: &mut dyn FnMut(&Progress) -> Control,
    ) -> Solution {
        // The weights of latent tensions follow the linearisation, so the loss need not fall
        // strictly from step to step close to the solution.
        let slack = match self.problem.method {
            Method::Joint => 1e-2,
            Method::Simple => 0.0,
        };
        let mut damping = 0.0;
        let mut iterations = 0;
        // Whether the last step from the present state was rejected.
        let mut rejected = false;
        self.poses.assemble(None, self.huber, damping);
        let termination = loop {
            let loss = self.loss();
            if !loss.is_finite() || damping > MOST_DAMPING {
                break Termination::Stalled;
            }
            let system = self.system();
            let Some((step, promised)) = system.step(damping) else {
                damping = raised(damping);
                self.poses.assemble(None, self.huber, damping);
                continue;
            };
            let promised = promised + self.poses.sums.decrease;
            let progress = Progress {
                iteration: iterations,
                loss,
                promised_decrease: promised,
                damping,
            };
            if promised <= options.tolerance * loss + 1e-15 {
                // Strong damping makes every promise small: that alone is no convergence.
                if damping <= FIRST_DAMPING {
                    break Termination::Converged;
                }
                if rejected {
                    break Termination::Stalled;
                }
                damping = lowered(damping);
                self.poses.assemble(None, self.huber, damping);
                continue;
            }
            if iterations == options.max_iterations {
                break Termination::IterationLimit;
            }
            if observer(&progress) == Control::Cancel {
                break Termination::Cancelled;
            }
            let before = (self.globals.clone(), self.home.clone(), self.priors.clone());
            let columns = self.map.column_step(&self.home, step.as_slice());
            self.globals
                .step(self.problem, &self.parameters, step.as_slice());
            self.evaluate_home();
            let next = lowered(damping);
            self.poses.assemble(Some(&columns), self.huber, next);
            if self.loss() <= loss * (1.0 + slack) {
                damping = next;
                iterations += 1;
                rejected = false;
                continue;
            }
            (self.globals, self.home, self.priors) = before;
            self.poses.undo_step();
            self.poses
                .set_globals(&self.globals, Some(&self.home.lengths));
            damping = raised(damping);
            rejected = true;
            self.poses.assemble(None, self.huber, damping);
        };
        self.finish(iterations, termination, damping)
    }

    fn finish(mut self, iterations: usize, termination: Termination, damping: f64) -> Solution {
        if damping != 0.0 {
            self.poses.assemble(None, self.huber, 0.0);
        }
        let chi2 = self.loss();
        let system = self.system();
        let priors = self
            .parameters
            .iter()
            .filter(|p| p.prior_sd.is_some())
            .count();
        let observations = self.poses.sums.readings + self.home.readings + priors as f64;
        let unknowns = self.poses.sums.coordinates + self.parameters.len() as f64;
        let free = match self.problem.poses {
            Poses::Estimated => self.problem.dataset.robot.platform.freedom().count(),
            Poses::HeldAtTracker => 0,
        };
        let all = free * self.poses.rows().len();
        let rows = self.poses.rows().to_vec();
        let home = self
            .home_evaluator
            .as_ref()
            .map(|e| (e.rows()[0], self.globals.home));
        let fitted = rows.into_iter().zip(self.poses.poses());
        let poses: Vec<_> = home.into_iter().chain(fitted).collect();
        Solution {
            outside_surface: outside_surface(self.problem, &self.globals, &poses),
            poses,
            covariance: covariance(&system),
            information: system.information,
            parameters: self.parameters,
            globals: self.globals,
            termination,
            iterations,
            chi2,
            degrees_of_freedom: observations - unknowns,
            undetermined_coordinates: all - self.poses.sums.coordinates as usize,
        }
    }
}

/// Inverse of the information, or nothing if it is singular but for rounding.
fn covariance(system: &System) -> Option<nalgebra::DMatrix<f64>> {
    let factor = system.information.clone().cholesky()?;
    let diagonal = factor.l_dirty().diagonal();
    let scale = system.information.diagonal();
    let regular = diagonal.iter().zip(&scale).all(|(l, d)| l * l > 1e-12 * d);
    regular.then(|| factor.inverse())
}

fn raised(damping: f64) -> f64 {
    (damping * 10.0).max(FIRST_DAMPING)
}

fn lowered(damping: f64) -> f64 {
    let lower = damping * 0.1;
    if lower < LEAST_DAMPING { 0.0 } else { lower }
}

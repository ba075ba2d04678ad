//! Solving with effects that depend on the pose of the platform.
//!
//! Wrap angles, directions of travel and the like are held during a solve, at poses that have to be known before. The
//! commanded poses may be far off or missing, so the problem is first solved without its free effects and the deviations of parts, and then again
//! with these quantities at the poses found, until chi-square no longer changes: the result is consistent with the poses
//! of the solution itself.

use tautline_core::estimation::{
    Control, EstimationError, Options, Problem, Progress, Solution, Termination,
    solve as solve_once,
};

use super::request::IdentificationRequest;

/// Relative change of chi-square below which the poses have settled.
const SETTLED: f64 = 1e-9;
/// Largest number of solves with the effects. Each starts at the previous one; two or three suffice in practice.
const MOST_SOLVES: usize = 10;

/// Solves a request; returns the problem in the form that was solved last.
pub(super) fn solve<'a>(
    request: &'a IdentificationRequest,
    observe: &mut dyn FnMut(&Progress) -> Control,
) -> Result<(Problem<'a>, Solution), EstimationError> {
    let mut problem = request.options.problem(&request.dataset, request.method)?;
    let options = Options::default();
    let deviations = std::mem::take(&mut problem.deviations);
    let mut solution = solve_once(&problem, &options, observe)?;
    problem.deviations = deviations;
    if !problem.depends_on_poses() && request.effects.is_empty() {
        return Ok((problem, solution));
    }
    let mut iterations = solution.iterations;
    let mut effects = request.effects.clone();
    for _ in 0..MOST_SOLVES {
        if solution.termination == Termination::Cancelled {
            break;
        }
        let before = solution.chi2;
        problem = problem.at_poses_of(&solution).with_effects(effects);
        solution = solve_once(&problem, &options, observe)?;
        iterations += solution.iterations;
        effects = solution.globals.effects[problem.held_effects.len()..].to_vec();
        if (solution.chi2 - before).abs() <= SETTLED * before {
            break;
        }
    }
    solution.iterations = iterations;
    Ok((problem, solution))
}

/// The same problem with its contexts at the poses of its own solution.
pub(super) fn at_poses_of<'a>(problem: Problem<'a>, solution: &Solution) -> Problem<'a> {
    if problem.depends_on_poses() {
        problem.at_poses_of(solution)
    } else {
        problem
    }
}

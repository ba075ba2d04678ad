//! Solving, with the clock running.

use std::time::Instant;

use anyhow::Result;
use tautline_core::effect::Search;
use tautline_core::estimation::{
    Analysis, Control, Options, Problem, Solution, deficiencies, solve,
};
use tautline_core::measurement::Dataset;
use tautline_core::robot::Robot;

use super::Fitted;
use crate::BadInput;
use tautline_workflow::documents::identification::extrapolated;

impl<'a> Fitted<'a> {
    /// Solves `problem` `repeat` times, keeps the least time, and analyses the residuals.
    pub fn solve(problem: &Problem<'a>, repeat: usize) -> Result<Self> {
        let ((problem, solution), seconds) = solve_repeatedly(problem, repeat)?;
        Ok(Self {
            analysis: Analysis::new(&problem, &solution),
            open: deficiencies(&problem, &solution),
            drawn_m: entry_points(&problem.dataset.robot),
            problem,
            solution,
            seconds,
        })
    }

    /// The same, compared with the drawing of another robot.
    pub fn compared_with(mut self, drawing: &Robot) -> Self {
        self.drawn_m = entry_points(drawing);
        self
    }
}

fn entry_points(robot: &Robot) -> Vec<[f64; 3]> {
    let cables = robot.cables.iter();
    cables.map(|cable| cable.pulley.entry_point_m).collect()
}

/// Runs `work` `repeat` times, at least once; the last result and the least time (s).
pub fn timed<T>(repeat: usize, mut work: impl FnMut() -> Result<T>) -> Result<(T, f64)> {
    let mut once = || {
        let start = Instant::now();
        work().map(|result| (result, start.elapsed().as_secs_f64()))
    };
    let (mut result, mut least) = once()?;
    for _ in 1..repeat {
        let (again, seconds) = once()?;
        result = again;
        least = least.min(seconds);
    }
    Ok((result, least))
}

/// Solves `repeat` times; the problem as it was solved, and the least time of a solve, set-up included.
fn solve_repeatedly<'a>(
    problem: &Problem<'a>,
    repeat: usize,
) -> Result<((Problem<'a>, Solution), f64)> {
    let once = |problem: &Problem<'_>| {
        solve(problem, &Options::default(), &mut |_| Control::Continue).map_err(BadInput::new)
    };
    let (solved, seconds) = timed(repeat, || {
        let mut problem = problem.clone();
        let mut solution = once(&problem)?;
        if depends_on_poses(&problem) {
            problem = problem.at_poses_of(&solution);
            solution = once(&problem)?;
        }
        Ok((problem, solution))
    })?;
    refuse_extrapolation(problem.dataset, &solved.1)?;
    Ok((solved, seconds))
}

/// Whether the model holds an effect that may depend on where the platform is: a first solve says that better than the
/// commanded poses do.
fn depends_on_poses(problem: &Problem<'_>) -> bool {
    let mut held = problem.held_effects.iter();
    held.any(|bound| bound.effect.search() != Search::Exchange)
}

/// A measured elongation is never extrapolated.
pub fn refuse_extrapolation(dataset: &Dataset, solution: &Solution) -> Result<()> {
    match extrapolated(dataset, solution) {
        None => Ok(()),
        Some(where_it_is) => Err(BadInput::new(where_it_is)),
    }
}

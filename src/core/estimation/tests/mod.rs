//! Tests of the estimator as a whole. Seeds are fixed; statistical tests state how improbable
//! their failure would be for a correct program.

mod assumed_tensions;
mod budget;
mod derivatives;
mod distances;
mod evaluation;
mod linearisation;
mod missing;
mod parts;
mod plain;
mod ports;
mod rank;
mod reference;
mod reliability;
mod robust;
mod start;
mod statistics;
mod surface;
mod tolerances;

use super::*;
use crate::measurement::Dataset;
use crate::robot::presets;
use crate::simulation::{Simulated, SimulationOptions, simulate};

fn quiet(_: &Progress) -> Control {
    Control::Continue
}

/// A simulated run of a preset.
fn run_of(name: &str, poses: usize, seed: u64) -> Simulated {
    run_with(name, poses, seed, |_| {})
}

/// A simulated run of a preset with changed options.
fn run_with(
    name: &str,
    poses: usize,
    seed: u64,
    change: impl Fn(&mut SimulationOptions),
) -> Simulated {
    let preset = presets::find(name).unwrap();
    let mut options = SimulationOptions {
        workspace: Some(preset.workspace),
        tension: Some(preset.tension),
        ..SimulationOptions::new(poses, seed)
    };
    change(&mut options);
    simulate(&preset.robot, &options).unwrap()
}

/// Solution to rounding: nothing is taken as negligible.
fn solved(problem: &Problem<'_>) -> Solution {
    let options = Options {
        negligible: 0.0,
        ..Options::default()
    };
    solve(problem, &options, &mut quiet).unwrap()
}

/// Converged solution of a dataset.
fn identified(dataset: &Dataset, method: Method) -> Solution {
    let problem = Problem::new(dataset).unwrap().with_method(method);
    let solution = solved(&problem);
    assert!(solution.converged(), "{:?}", solution.termination);
    solution
}

/// Errors of the entry points by their covariance: a chi-square variable, and its degrees of freedom.
fn entry_error(run: &Simulated, solution: &Solution) -> (f64, f64) {
    let free = solution.parameters.iter().enumerate();
    let free: Vec<(usize, f64)> = free
        .filter_map(|(k, p)| match p.id {
            ParameterId::EntryPoint { cable, axis } => {
                let truth = run.truth.cables[cable].pulley.entry_point_m[axis];
                Some((k, solution.globals.entry_points[cable][axis] - truth))
            }
            _ => None,
        })
        .collect();
    let covariance = solution.covariance.as_ref().unwrap();
    let n = free.len();
    let block = nalgebra::DMatrix::from_fn(n, n, |i, k| covariance[(free[i].0, free[k].0)]);
    let error = nalgebra::DVector::from_iterator(n, free.iter().map(|(_, e)| *e));
    (
        error.dot(&block.cholesky().unwrap().solve(&error)),
        n as f64,
    )
}

/// Largest difference of entry points, in standard deviations of the first solution.
fn difference_in_sd(first: &Solution, second: &Solution) -> f64 {
    let mut worst = 0.0_f64;
    for (k, parameter) in first.parameters.iter().enumerate() {
        if let ParameterId::EntryPoint { cable, axis } = parameter.id {
            let moved =
                first.globals.entry_points[cable][axis] - second.globals.entry_points[cable][axis];
            worst = worst.max(moved.abs() / first.standard_deviation(k).unwrap());
        }
    }
    worst
}

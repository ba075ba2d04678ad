//! Robots without force sensors whose tensions follow from balance within the stated limits.

use super::*;
use crate::measurement::Grid;
use crate::robot::ForceSensor;

/// Standard deviations that a sum may be above its expectation: each of the sums below fails with probability below 3e-7 if
/// normal.
const LIMIT: f64 = 5.0;

/// A run of a robot whose cables pull, as it is measured without force sensors: tensions are held around a reference that is
/// so many times the stated one.
fn unread(name: &str, seed: u64, reference: f64) -> Simulated {
    let mut run = run_with(name, 20, seed, |options| {
        let range = options.tension.as_mut().unwrap();
        range.reference_n *= reference;
    });
    for cable in &mut run.dataset.robot.cables {
        cable.force_sensor = None;
    }
    run.dataset.measurements.force_n = Grid::default();
    run
}

fn solved_twice<'a>(dataset: &'a Dataset) -> (Problem<'a>, Solution) {
    let problem = Problem::new(dataset).unwrap();
    let first = solved(&problem);
    let problem = problem.at_poses_of(&first);
    let solution = solved(&problem);
    (problem, solution)
}

#[test]
fn entry_points_are_within_their_uncertainty_whatever_the_tension_is() {
    for name in ["mini", "hall", "suspended", "planar"] {
        for reference in [0.8, 1.0, 1.25] {
            let (mut errors, mut coordinates) = (0.0, 0.0);
            let (mut chi2, mut freedom) = (0.0, 0.0);
            for seed in 0..6 {
                let run = unread(name, 700 + seed, reference);
                let (_, solution) = solved_twice(&run.dataset);
                let (error, count) = entry_error(&run, &solution);
                errors += error;
                coordinates += count;
                chi2 += solution.chi2;
                freedom += solution.degrees_of_freedom;
            }
            let away = (errors - coordinates) / (2.0 * coordinates).sqrt();
            assert!(away < LIMIT, "{name}: {errors} of {coordinates}");
            let away = (chi2 - freedom) / (2.0 * freedom).sqrt();
            assert!(away < LIMIT, "{name}: chi-square {chi2} of {freedom}");
        }
    }
}

#[test]
fn without_stated_limits_the_stretch_of_the_cables_is_missing() {
    let mut run = unread("mini", 710, 1.0);
    run.dataset.robot.limits = None;
    let (problem, solution) = solved_twice(&run.dataset);
    assert!(!problem.has_equilibrium());
    assert!(solution.chi2 > 1.5 * solution.degrees_of_freedom);
}

#[test]
fn an_assumed_tension_is_a_reading_as_uncertain_as_the_limits() {
    let run = unread("mini", 720, 1.2);
    let (problem, assumed) = solved_twice(&run.dataset);
    let contexts = problem.contexts.as_ref().unwrap();
    let mut read = run.dataset.clone();
    let limits = read.robot.unread_tension().unwrap();
    for cable in &mut read.robot.cables {
        cable.force_sensor = Some(ForceSensor {
            tension_gain: 1.0,
            bias_n: 0.0,
            tension_sd_n: limits.sd_n(),
        });
    }
    let count = read.robot.cable_count();
    let mut forces = Grid::missing(read.measurements.len(), count);
    for row in 0..read.measurements.len() {
        for cable in 0..count {
            forces.set(row, cable, contexts.cable(row, cable).tension_n);
        }
    }
    read.measurements.force_n = forces;
    let as_read = identified(&read, Method::Joint);
    assert!((assumed.chi2 - as_read.chi2).abs() < 1e-6 * as_read.chi2);
    assert!(difference_in_sd(&assumed, &as_read) < 1e-4);
    // Six equations of balance at home and at each pose are satisfied by what was assumed.
    let fewer = as_read.degrees_of_freedom - assumed.degrees_of_freedom;
    assert!((fewer - 126.0).abs() < 1e-9, "{fewer}");
}

//! Fitting poses only, and holding poses at the external instrument.

use super::*;
use crate::robot::{PerAxis, Tracker};

/// Probability of a chi-square as large, below which these tests fail: there are 12 of them.
const LEAST_PROBABILITY: f64 = 1e-6;

#[test]
fn held_geometry_fits_poses_only() {
    for name in presets::NAMES {
        let run = run_of(name, 25, 41);
        let truth = Dataset {
            robot: run.truth.clone(),
            measurements: run.dataset.measurements.clone(),
        };
        for method in [Method::Joint, Method::Simple] {
            let mut dataset = truth.clone();
            if method == Method::Simple {
                for row in 0..dataset.measurements.len() {
                    for (index, cable) in run.truth.cables.iter().enumerate() {
                        let tension = dataset.measurements.truth.tension_n.get(row, index);
                        let reading = cable.force_sensor.unwrap().reading_n(tension);
                        dataset.measurements.force_n.set(row, index, reading);
                    }
                }
            }
            let mut problem = Problem::new(&dataset).unwrap().with_method(method);
            problem.geometry = Geometry::Held;
            let solution = solved(&problem);
            assert!(solution.converged());
            for (point, cable) in solution.globals.entry_points.iter().zip(&run.truth.cables) {
                assert_eq!(*point, cable.pulley.entry_point_m);
            }
            assert_eq!(solution.globals.home, run.truth.home.unwrap().pose());
            let p = solution.p_value().unwrap();
            assert!(
                p > LEAST_PROBABILITY && p < 1.0 - LEAST_PROBABILITY,
                "{name} {method:?}: chi-square {} of {}",
                solution.chi2,
                solution.degrees_of_freedom
            );
            let analysis = Analysis::new(&problem, &solution);
            let readings = analysis.observations.iter().filter_map(|r| r.redundancy);
            let sum =
                readings.sum::<f64>() + analysis.prior_redundancies.iter().flatten().sum::<f64>();
            assert!((sum - solution.degrees_of_freedom).abs() < 1e-6);
        }
    }
}

#[test]
fn the_nominal_geometry_fits_worse_than_the_identified_one() {
    let run = run_of("mini", 30, 42);
    let evaluated = |robot: &crate::robot::Robot| {
        let dataset = Dataset {
            robot: robot.clone(),
            measurements: run.dataset.measurements.clone(),
        };
        let mut problem = Problem::new(&dataset).unwrap();
        problem.geometry = Geometry::Held;
        solved(&problem).chi2
    };
    assert!(evaluated(&run.dataset.robot) > 10.0 * evaluated(&run.truth));
}

/// A run of MINI with an external instrument.
fn tracked(poses: usize, seed: u64) -> Simulated {
    let preset = presets::find("mini").unwrap();
    let mut robot = preset.robot.clone();
    robot.tracker = Some(Tracker {
        position_sd_m: PerAxis::Same(1e-6),
        orientation_sd_rad: Some(1e-6),
    });
    let options = SimulationOptions {
        workspace: Some(preset.workspace),
        tension: Some(preset.tension),
        ..SimulationOptions::new(poses, seed)
    };
    simulate(&robot, &options).unwrap()
}

#[test]
fn poses_held_at_the_instrument_do_not_move() {
    let mut run = tracked(20, 43);
    // One row without instrument is left out.
    run.dataset.measurements.tracked_position_m[5] = [f64::NAN; 3];
    let problem = || {
        let mut problem = Problem::new(&run.dataset).unwrap();
        problem.poses = Poses::HeldAtTracker;
        problem
    };
    let problem = problem();
    let solution = solved(&problem);
    assert!(solution.converged());
    assert_eq!(solution.undetermined_coordinates, 0);
    assert_eq!(solution.poses.len(), 20);
    for (row, pose) in &solution.poses[1..] {
        let truth = run.dataset.measurements.truth.poses[*row];
        assert_ne!(*row, 5);
        let off = pose.difference(&truth);
        // Five standard deviations of 114 readings of the instrument: one of 15 000 runs fails.
        assert!(off.iter().all(|v| v.abs() < 5e-6), "{off:?}");
    }
    // Errors of 1 um of the instrument are nothing against the noise of lengths, but the balance of
    // forces and the lengths together see little of them: chi-square stays near its expectation.
    let p = solution.p_value().unwrap();
    assert!(
        p > LEAST_PROBABILITY,
        "{} of {}",
        solution.chi2,
        solution.degrees_of_freedom
    );
    // Known poses determine the pulleys better than unknown ones.
    let without = {
        let mut dataset = run.dataset.clone();
        dataset.robot.tracker = None;
        identified(&dataset, Method::Joint)
    };
    let variance = |s: &Solution| s.covariance.as_ref().unwrap()[(0, 0)];
    assert!(variance(&solution) < variance(&without));
}

#[test]
fn held_poses_and_geometry_leave_nothing_to_fit_but_tensions_at_home() {
    let run = tracked(10, 44);
    let dataset = Dataset {
        robot: run.truth.clone(),
        measurements: run.dataset.measurements.clone(),
    };
    for (method, unknowns) in [(Method::Joint, 8), (Method::Simple, 0)] {
        let mut problem = Problem::new(&dataset).unwrap().with_method(method);
        problem.geometry = Geometry::Held;
        problem.poses = Poses::HeldAtTracker;
        let solution = solved(&problem);
        assert!(solution.converged());
        assert_eq!(solution.parameters.len(), unknowns);
        assert!(Analysis::new(&problem, &solution).observations.len() > 80);
        assert_eq!(rank_defects(&problem, &solution), []);
    }
}

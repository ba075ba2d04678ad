//! Start values, and the path from them to the solution.

use super::*;
use crate::simulation::TrueGeometry;

#[test]
fn noise_free_data_give_back_the_truth() {
    for name in presets::NAMES {
        let run = run_with(name, 20, 5, |o| {
            o.noise = false;
            o.geometry = TrueGeometry::Nominal;
        });
        for method in [Method::Joint, Method::Simple] {
            let solution = identified(&run.dataset, method);
            // Rounding of lengths of some 10 m: 1e-15 m against 5e-5 m, over a few hundred rows.
            assert!(solution.chi2 < 1e-15, "{name} {:e}", solution.chi2);
            for (point, cable) in solution.globals.entry_points.iter().zip(&run.truth.cables) {
                for k in 0..3 {
                    assert!((point[k] - cable.pulley.entry_point_m[k]).abs() < 1e-8);
                }
            }
        }
    }
}

#[test]
fn poses_that_were_not_commanded_start_from_forward_kinematics() {
    for name in presets::NAMES {
        let run = run_of(name, 25, 6);
        let mut without = run.dataset.clone();
        without.measurements.commanded.clear();
        for method in [Method::Joint, Method::Simple] {
            let with = identified(&run.dataset, method);
            let found = identified(&without, method);
            let off = difference_in_sd(&with, &found);
            // Both stop within 1e-11 of the least sum of squares; the joint method's weights
            // converge linearly.
            assert!(off < 1e-3, "{name} {method:?}: {off:e}");
            assert!((with.chi2 - found.chi2).abs() < 1e-5 * with.chi2, "{name}");
        }
    }
}

#[test]
fn absolute_lengths_without_home_and_commands_have_a_start() {
    let mut run = run_of("mini", 20, 7);
    let dataset = &mut run.dataset;
    absolute(dataset, &run.truth);
    let with = identified(dataset, Method::Simple);
    dataset.measurements.commanded.clear();
    let found = identified(dataset, Method::Simple);
    assert!(difference_in_sd(&with, &found) < 1e-3);
    assert!(with.p_value().unwrap() > 1e-6);
}

/// Replaces revolutions by the absolute lengths that the true robot has.
pub fn absolute(dataset: &mut Dataset, truth: &crate::robot::Robot) {
    let data = &mut dataset.measurements;
    let mut lengths = crate::measurement::Grid::missing(data.len(), dataset.robot.cable_count());
    for row in 0..data.len() {
        let states = crate::kinematics::inverse_kinematics(truth, &data.truth.poses[row]).unwrap();
        for (index, state) in states.iter().enumerate() {
            lengths.set(row, index, state.length_m);
        }
    }
    data.revolutions = crate::measurement::Grid::default();
    data.length_m = lengths;
    dataset.robot.home = None;
    for cable in &mut dataset.robot.cables {
        cable.cable.axial_stiffness_n = None;
        cable.winch.length_to_pulley_m = 0.0;
    }
    for label in &mut data.labels {
        *label += 1;
    }
}

#[test]
fn damping_leads_back_from_far_away() {
    let run = run_of("mini", 20, 8);
    let near = identified(&run.dataset, Method::Joint);
    let mut far = run.dataset.clone();
    for (row, pose) in far.measurements.commanded.iter_mut().enumerate() {
        let side = if row % 2 == 0 { 0.3 } else { -0.3 };
        pose.as_mut().unwrap().position += crate::geometry::Vec3::new(side, 0.0, 0.0);
    }
    for method in [Method::Simple, Method::Joint] {
        let found = identified(&far, method);
        let near = match method {
            Method::Joint => near.clone(),
            Method::Simple => identified(&run.dataset, method),
        };
        assert!(difference_in_sd(&near, &found) < 1e-3, "{method:?}");
    }
}

#[test]
fn observers_cancel_and_limits_hold() {
    let run = run_of("mini", 20, 9);
    let problem = Problem::new(&run.dataset).unwrap();
    let mut calls = 0;
    let mut cancel = |_: &Progress| {
        calls += 1;
        Control::Cancel
    };
    let stopped = solve(&problem, &Options::default(), &mut cancel).unwrap();
    assert_eq!(stopped.termination, Termination::Cancelled);
    assert_eq!((stopped.iterations, calls), (0, 1));
    let nominal = Globals::nominal(&problem);
    assert_eq!(stopped.globals.entry_points, nominal.entry_points);

    let mut third = |progress: &Progress| {
        if progress.iteration == 2 {
            Control::Cancel
        } else {
            Control::Continue
        }
    };
    let stopped = solve(&problem, &Options::default(), &mut third).unwrap();
    assert_eq!(stopped.termination, Termination::Cancelled);
    assert_eq!(stopped.iterations, 2);

    let limited = Options {
        max_iterations: 2,
        ..Options::default()
    };
    let limited = solve(&problem, &limited, &mut quiet).unwrap();
    assert_eq!(limited.termination, Termination::IterationLimit);
    assert_eq!(limited.iterations, 2);
    assert!(!limited.converged());
}

#[test]
fn what_the_joint_method_neglects_is_far_below_a_standard_deviation() {
    for name in presets::NAMES {
        for seed in 0..5 {
            let run = run_of(name, 25, seed);
            let exact = identified(&run.dataset, Method::Joint);
            let problem = Problem::new(&run.dataset).unwrap();
            let usual = solve(&problem, &Options::default(), &mut quiet).unwrap();
            let off = difference_in_sd(&exact, &usual);
            assert!(off < 0.01, "{name} {seed}: {off:e}");
        }
    }
}

//! Undetermined parameters are named in sentences, and nothing panics.

use super::*;
use crate::effect::{BoundEffect, Effect, EffectParameter};
use crate::geometry::Coordinate;
use crate::robot::{PerAxis, Robot};

fn sentences(dataset: &Dataset, method: Method) -> Vec<String> {
    let problem = Problem::new(dataset).unwrap().with_method(method);
    sentences_of(&problem)
}

fn sentences_of(problem: &Problem<'_>) -> Vec<String> {
    let solution = solved(problem);
    let analysis = Analysis::new(problem, &solution);
    assert!(!analysis.observations.is_empty());
    let found = rank_defects(problem, &solution);
    if solution.undetermined_coordinates == 0 {
        assert_eq!(found.is_empty(), solution.covariance.is_some());
    }
    found.into_iter().map(|d| d.sentence).collect()
}

fn mentions(sentences: &[String], words: &str) -> bool {
    sentences.iter().any(|s| s.contains(words))
}

fn free_entry_points(robot: &mut Robot) {
    for cable in &mut robot.cables {
        cable.pulley.entry_point_sd_m = PerAxis::default();
    }
}

/// MINI with absolute lengths and nothing known of its pulleys.
fn floating(radius_m: f64) -> Dataset {
    let mut run = run_of("mini", 25, 31);
    for robot in [&mut run.dataset.robot, &mut run.truth] {
        for cable in &mut robot.cables {
            cable.pulley.radius_m = radius_m;
        }
    }
    start::absolute(&mut run.dataset, &run.truth);
    free_entry_points(&mut run.dataset.robot);
    run.dataset
}

#[test]
fn without_any_datum_all_motions_are_open() {
    // Pulleys swivel about given axes, which fixes rotations across them; eyelets have none.
    for (radius_m, count) in [(0.018, 4), (0.0, 6)] {
        let mut dataset = floating(radius_m);
        dataset.robot.laser = None;
        let found = sentences(&dataset, Method::Simple);
        assert_eq!(found.len(), count, "{found:?}");
        for axis in ["x", "y", "z"] {
            let shift = format!("a shift along {axis}");
            assert!(mentions(&found, &shift), "{found:?}");
            let turn = format!("a rotation about {axis}");
            let expected = radius_m == 0.0 || axis == "z";
            assert_eq!(mentions(&found, &turn), expected, "{found:?}");
        }
    }
}

#[test]
fn unknown_coordinates_of_a_known_pulley_stay_open() {
    let mut dataset = floating(0.018);
    dataset.robot.laser = None;
    for cable in &mut dataset.robot.cables {
        cable.pulley.entry_point_sd_m = PerAxis::Each([None, None, Some(0.0)]);
    }
    let found = sentences(&dataset, Method::Simple);
    assert_eq!(found.len(), 3, "{found:?}");
    for motion in ["a shift along x", "a shift along y", "a rotation about z"] {
        assert!(mentions(&found, motion), "{found:?}");
    }
}

#[test]
fn a_laser_on_a_known_plane_leaves_shifts_and_a_rotation() {
    let mut dataset = floating(0.018);
    let laser = dataset.robot.laser.as_mut().unwrap();
    laser.target_plane.offset_sd_m = Some(0.0);
    for method in [Method::Simple, Method::Joint] {
        let found = sentences(&dataset, method);
        assert_eq!(found.len(), 3, "{found:?}");
        assert!(mentions(&found, "a shift along x"), "{found:?}");
        assert!(mentions(&found, "a shift along y"), "{found:?}");
        assert!(mentions(&found, "a rotation about z"), "{found:?}");
    }
}

#[test]
fn gravity_leaves_a_rotation_about_the_vertical() {
    let mut dataset = floating(0.018);
    dataset.robot.laser = None;
    let found = sentences(&dataset, Method::Joint);
    assert_eq!(found.len(), 4, "{found:?}");
    assert!(mentions(&found, "a rotation about z"), "{found:?}");
    assert!(!mentions(&found, "a rotation about x"), "{found:?}");
}

#[test]
fn one_pulley_as_datum_leaves_the_rotation_about_it_mixed_or_named() {
    let mut dataset = floating(0.018);
    let laser = dataset.robot.laser.as_mut().unwrap();
    laser.target_plane.offset_sd_m = Some(0.0);
    // The first pulley is given: now only the rotation about the vertical through it is open.
    dataset.robot.cables[0].pulley.entry_point_sd_m = PerAxis::known(0.0);
    let found = sentences(&dataset, Method::Simple);
    assert_eq!(found.len(), 1, "{found:?}");
}

#[test]
fn a_datum_by_zero_standard_deviations_determines_everything() {
    let mut dataset = floating(0.018);
    // 3-2-1: six coordinates of three pulleys.
    let datum = [
        (0, [0.0, 0.0, 0.0]),
        (1, [1.0, 0.0, 0.0]),
        (2, [1.0, 1.0, 0.0]),
    ];
    for (cable, sd) in datum {
        dataset.robot.cables[cable].pulley.entry_point_sd_m = PerAxis::Each(sd.map(Some));
    }
    for method in [Method::Simple, Method::Joint] {
        let problem = Problem::new(&dataset).unwrap().with_method(method);
        let solution = solved(&problem);
        assert_eq!(rank_defects(&problem, &solution), []);
        assert!(solution.covariance.is_some());
        for (cable, sd) in datum {
            for axis in 0..3 {
                let id = ParameterId::EntryPoint { cable, axis };
                let free = solution.parameters.iter().any(|p| p.id == id);
                assert_eq!(free, sd[axis] > 0.0);
                let nominal = dataset.robot.cables[cable].pulley.entry_point_m[axis];
                let moved = solution.globals.entry_points[cable][axis] != nominal;
                assert_eq!(moved, sd[axis] > 0.0);
            }
        }
    }
}

#[test]
fn a_parameter_on_which_nothing_depends_is_named() {
    let mut run = run_of("planar", 15, 32);
    run.dataset.robot.cables[1].pulley.entry_point_sd_m = PerAxis::default();
    for method in [Method::Simple, Method::Joint] {
        let found = sentences(&run.dataset, method);
        let expected = "no reading depends on cable-2 entry point z";
        assert_eq!(found.len(), 1, "{found:?}");
        assert!(mentions(&found, expected), "{found:?}");
        // The rest is fitted all the same.
        let problem = Problem::new(&run.dataset).unwrap().with_method(method);
        assert!(solved(&problem).converged());
    }
}

/// A scale of all winches of which nothing is known beforehand.
static UNKNOWN_SCALE: Effect = Effect {
    id: "winch_scale_common",
    parameters: &[EffectParameter::new(
        "scale",
        "1",
        f64::INFINITY,
        [0.001, 0.01],
    )],
    change_cable: |p, _, ports| ports.paid *= p[0] + 1.0,
    ..Effect::NEUTRAL
};

#[test]
fn a_common_scale_is_named() {
    // A point mass on eyelets: nothing but the pulleys has a length of its own.
    let mut run = run_of("mini", 25, 33);
    let dataset = &mut run.dataset;
    dataset.robot.platform.free = vec![Coordinate::X, Coordinate::Y, Coordinate::Z];
    dataset.robot.laser = None;
    for cable in &mut dataset.robot.cables {
        cable.platform_anchor_m = [0.0; 3];
        cable.pulley.radius_m = 0.0;
        cable.cable.axial_stiffness_n = None;
    }
    free_entry_points(&mut dataset.robot);
    let data = &mut dataset.measurements;
    let mut truth = dataset.robot.clone();
    for (cable, other) in truth.cables.iter_mut().zip(&run.truth.cables) {
        cable.pulley.entry_point_m = other.pulley.entry_point_m;
    }
    let lengths = |row: usize| -> Vec<f64> {
        let position = data.truth.poses[row].position.into();
        let pose = crate::geometry::Pose::from_parts(position, [1.0, 0.0, 0.0, 0.0]);
        let states = crate::kinematics::inverse_kinematics(&truth, &pose).unwrap();
        states.iter().map(|s| s.length_m).collect()
    };
    let all: Vec<Vec<f64>> = (0..data.len()).map(lengths).collect();
    for (row, lengths) in all.iter().enumerate() {
        for (index, length) in lengths.iter().enumerate() {
            let winch = dataset.robot.cables[index].winch;
            let paid = (length - all[0][index]) / winch.cable_per_revolution_m();
            data.revolutions.set(row, index, paid);
        }
    }
    let mut problem = Problem::new(dataset).unwrap().with_method(Method::Simple);
    problem.free_effects = vec![BoundEffect {
        effect: &UNKNOWN_SCALE,
        cables: (0..8).collect(),
        targeted: false,
        values: vec![0.0],
    }];
    let found = sentences_of(&problem);
    // A point mass leaves also the rotations about its home position open.
    assert!(
        mentions(&found, "a common scale of all lengths"),
        "{found:?}"
    );
    for axis in ["x", "y", "z"] {
        assert!(
            mentions(&found, &format!("a rotation about {axis}")),
            "{found:?}"
        );
    }
    assert_eq!(found.len(), 4, "{found:?}");
}

#[test]
fn a_pose_with_too_few_cables_is_told() {
    let mut run = run_of("mini", 20, 34);
    let data = &mut run.dataset.measurements;
    for cable in 3..8 {
        data.revolutions.set(4, cable, f64::NAN);
        data.force_n.set(4, cable, f64::NAN);
    }
    data.laser_m[4] = f64::NAN;
    for method in [Method::Simple, Method::Joint] {
        let problem = Problem::new(&run.dataset).unwrap().with_method(method);
        let solution = solved(&problem);
        assert!(solution.converged());
        assert_eq!(solution.undetermined_coordinates, 3);
        let found = sentences(&run.dataset, method);
        assert!(
            mentions(&found, "leave 3 pose coordinates undetermined"),
            "{found:?}"
        );
    }
}

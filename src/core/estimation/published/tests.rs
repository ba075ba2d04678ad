//! Tests of the published method on data without noise.

use super::*;
use crate::geometry::{Pose, Twist, Vec3};
use crate::kinematics::{inverse_kinematics, samples};
use crate::measurement::{Grid, Measurements};
use crate::robot::{ForceSensor, Home, Laser, TargetPlane};
use rand::RngExt;

const TENSION_N: f64 = 30.0;
const STIFFNESS_N: f64 = 4e4;

/// `robot` with home pose, laser and force sensors.
fn equipped(mut robot: Robot, laser_direction: [f64; 3]) -> Robot {
    robot.home = Some(Home {
        position_m: [0.0; 3],
        orientation_wxyz: [1.0, 0.0, 0.0, 0.0],
        position_sd_m: 1e-4,
        orientation_sd_rad: 5e-4,
        covariance: None,
    });
    robot.laser = Some(Laser {
        origin_m: [0.0, 0.0, -0.055],
        direction: laser_direction,
        sd_m: 3e-4,
        target_plane: TargetPlane {
            normal: laser_direction.map(|v| -v),
            offset_m: -0.5,
            offset_sd_m: Some(5e-3),
        },
    });
    for cable in &mut robot.cables {
        cable.cable.axial_stiffness_n = Some(STIFFNESS_N);
        cable.force_sensor = Some(ForceSensor {
            tension_gain: 2.0,
            bias_n: 1.0,
            tension_sd_n: 1.0,
        });
    }
    robot
}

fn lengths(robot: &Robot, pose: &Pose) -> Vec<f64> {
    let states = inverse_kinematics(robot, pose).unwrap();
    states.iter().map(|state| state.length_m).collect()
}

/// Exact readings of `truth` at random poses, all at one tension, with `nominal` as description.
fn dataset(nominal: &Robot, truth: &Robot, count: i64) -> Dataset {
    let m = truth.cable_count();
    let laser = truth.laser.unwrap();
    let mut rng = samples::generator(41);
    let mut measured = Measurements {
        revolutions: Grid::new(m),
        force_n: Grid::new(m),
        ..Measurements::default()
    };
    let home = lengths(truth, &Pose::identity());
    for label in 0..=count {
        let mut twist = Twist::zeros();
        for coordinate in truth.platform.freedom().coordinates() {
            let scale = [0.15, 0.1][coordinate.index() / 3];
            twist[coordinate.index()] = scale * rng.random_range(-1.0..1.0);
        }
        let twist = twist * f64::from(u8::from(label > 0));
        let pose = Pose::identity().perturbed(&twist);
        let strain = 1.0 + TENSION_N / STIFFNESS_N;
        let changes = lengths(truth, &pose).into_iter().zip(&home).enumerate();
        let revolutions: Vec<f64> = changes
            .map(|(i, (l, l0))| (l - l0) / strain / truth.cables[i].winch.cable_per_revolution_m())
            .collect();
        let normal = Vec3::from(laser.target_plane.normal);
        let origin = pose.transform(&laser.origin_m.into());
        let direction = pose.orientation * Vec3::from(laser.direction);
        measured.labels.push(label);
        measured.commanded.push((label % 2 == 0).then_some(pose));
        measured.revolutions.push_row(&revolutions);
        measured.force_n.push_row(&vec![2.0 * TENSION_N + 1.0; m]);
        let distance = (-0.5 - normal.dot(&origin)) / normal.dot(&direction);
        measured.laser_m.push(distance);
    }
    Dataset {
        robot: nominal.clone(),
        measurements: measured,
    }
}

/// `robot` with entry points displaced by up to 5 mm per coordinate.
fn displaced(robot: &Robot) -> Robot {
    let mut rng = samples::generator(42);
    let mut truth = robot.clone();
    for cable in &mut truth.cables {
        for coordinate in robot.platform.freedom().coordinates() {
            if coordinate.index() < 3 {
                let entry = &mut cable.pulley.entry_point_m;
                entry[coordinate.index()] += rng.random_range(-0.005..0.005);
            }
        }
    }
    truth
}

fn entries(robot: &Robot) -> Vec<[f64; 3]> {
    let cables = robot.cables.iter();
    cables.map(|cable| cable.pulley.entry_point_m).collect()
}

fn largest_difference(a: &[[f64; 3]], b: &[[f64; 3]]) -> f64 {
    let pairs = a.iter().flatten().zip(b.iter().flatten());
    pairs.fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()))
}

#[test]
fn parameters_are_those_of_the_paper() {
    let parameters = published_parameters(&samples::spatial(0.018));
    let named: Vec<String> = parameters
        .iter()
        .map(|p| format!("{}{}", ["x", "y", "z"][p.axis], p.cable + 1))
        .collect();
    let expected = "x2 x3 x4 x5 x6 x7 y2 y3 y4 y5 y6 y7 z5 z6 z7 z8";
    assert_eq!(named.join(" "), expected);
    assert_eq!(published_parameters(&samples::planar(0.02)).len(), 4);
}

#[test]
fn exact_data_with_the_rest_given_exactly_are_solved() {
    let nominal = equipped(samples::spatial(0.018), [0.0, 0.0, -1.0]);
    let truth = displaced(&nominal);
    let data = dataset(&nominal, &truth, 25);
    let options = PublishedOptions {
        given_entry_points_m: Some(entries(&truth)),
        step_stop_m: 1e-10,
        ..PublishedOptions::for_robot(&nominal)
    };
    let result = identify_published(&data, &options).unwrap();
    assert_eq!(result.stop, PublishedStop::SmallStep);
    assert_eq!(result.history.len(), result.iterations + 1);
    let off = largest_difference(&result.entry_points_m, &entries(&truth));
    assert!(off < 1e-7, "{off:e}");
    // Steps of half the Newton step halve the error.
    let norms = |k: usize| result.history[k].error_norm_m;
    assert!((norms(10) / norms(9) - 0.5).abs() < 0.01);
}

#[test]
fn planar_robot_is_solved() {
    let nominal = equipped(samples::planar(0.02), [0.0, -1.0, 0.0]);
    let truth = displaced(&nominal);
    let data = dataset(&nominal, &truth, 30);
    let options = PublishedOptions {
        given_entry_points_m: Some(entries(&truth)),
        step_stop_m: 1e-9,
        ..PublishedOptions::for_robot(&nominal)
    };
    let result = identify_published(&data, &options).unwrap();
    let off = largest_difference(&result.entry_points_m, &entries(&truth));
    assert!(off < 1e-6, "{off:e} {:?}", result.stop);
}

#[test]
fn stops_are_told_apart() {
    let nominal = equipped(samples::spatial(0.018), [0.0, 0.0, -1.0]);
    let mut data = dataset(&nominal, &displaced(&nominal), 10);
    let mut options = PublishedOptions::for_robot(&nominal);
    options.iteration_limit = 3;
    let result = identify_published(&data, &options).unwrap();
    assert_eq!(
        (result.stop, result.iterations),
        (PublishedStop::IterationLimit, 3)
    );
    options.error_stop_m = 1.0;
    let result = identify_published(&data, &options).unwrap();
    assert_eq!(
        (result.stop, result.iterations),
        (PublishedStop::SmallError, 1)
    );
    data.measurements.revolutions.set(3, 0, f64::INFINITY);
    let result = identify_published(&data, &options).unwrap();
    assert_eq!(result.stop, PublishedStop::Diverged);
}

#[test]
fn what_is_missing_is_said() {
    let nominal = equipped(samples::spatial(0.018), [0.0, 0.0, -1.0]);
    let options = PublishedOptions::for_robot(&nominal);
    let data = dataset(&nominal, &nominal, 3);
    let message = |data: &Dataset| identify_published(data, &options).unwrap_err().to_string();
    let mut without = data.clone();
    without.robot.laser = None;
    assert_eq!(
        message(&without),
        "the published method needs a laser distance sensor"
    );
    let mut without = data.clone();
    without.measurements.laser_m[2] = f64::NAN;
    assert_eq!(
        message(&without),
        "the published method needs a laser distance at every pose, pose 2 has none"
    );
    let mut without = data.clone();
    without.robot.cables[3].force_sensor = None;
    assert_eq!(
        message(&without),
        "the published method needs a force sensor on every cable"
    );
    let wrong = PublishedOptions {
        given_entry_points_m: Some(Vec::new()),
        ..options.clone()
    };
    let error = identify_published(&data, &wrong).unwrap_err();
    assert_eq!(error, PublishedError::Parameters { cables: 8 });
}

//! Tests of the forward kinematics. Seeds are fixed and nothing depends on time or threads, so no
//! test fails by chance.

use super::super::inverse_kinematics;
use super::super::samples::{self, PlatformKind};
use super::*;
use crate::geometry::{Coordinate, Twist};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

fn lengths(robot: &Robot, pose: &Pose) -> Option<Vec<f64>> {
    let states = inverse_kinematics(robot, pose).ok()?;
    Some(states.iter().map(|state| state.length_m).collect())
}

/// `centre` moved in the free coordinates, at most by `half` (m) and `turn` (rad) per coordinate.
fn random_pose(
    rng: &mut ChaCha8Rng,
    robot: &Robot,
    centre: &Pose,
    half: [f64; 3],
    turn: f64,
) -> Pose {
    let mut twist = Twist::zeros();
    for coordinate in robot.platform.freedom().coordinates() {
        let k = coordinate.index();
        let scale = if k < 3 { half[k] } else { turn };
        twist[k] = scale * rng.random_range(-1.0..1.0);
    }
    centre.perturbed(&twist)
}

/// The robot kinds and half the half widths of their frames (m).
const KINDS: [(PlatformKind, [f64; 3]); 3] = [
    (PlatformKind::Spatial, [0.25, 0.19, 0.22]),
    (PlatformKind::Planar, [0.4, 0.3, 0.0]),
    (PlatformKind::PointMass, [0.75, 0.5, 0.55]),
];

#[derive(Debug, Default, PartialEq)]
struct Tally {
    right: usize,
    /// Another pose with the same lengths.
    second_solution: usize,
    flagged: usize,
    wrong: usize,
}

/// Solves from the centre for random poses within `half` and `turn`.
fn tally(robot: &Robot, half: [f64; 3], turn: f64, count: usize) -> Tally {
    let solver = ForwardKinematics::new(robot).unwrap();
    let mut rng = samples::generator(31);
    let mut tally = Tally::default();
    for _ in 0..count {
        let pose = random_pose(&mut rng, robot, solver.centre(), half, turn);
        let Some(lengths) = lengths(robot, &pose) else {
            continue;
        };
        let found = solver.solve_from_anywhere(&lengths);
        let off = found.pose.difference(&pose).norm();
        if !found.converged {
            tally.flagged += 1;
        } else if off < 1e-8 {
            tally.right += 1;
        } else if found.residual_rms_m < 1e-11 {
            tally.second_solution += 1;
        } else {
            tally.wrong += 1;
        }
    }
    tally
}

#[test]
fn every_pose_of_the_workspace_is_found_from_its_centre() {
    for (kind, half) in KINDS {
        for radius in [0.0, 0.02] {
            let tally = tally(&samples::of_kind(kind, radius), half, 0.5, 4000);
            println!("{kind:?}, radius {radius}: {tally:?}");
            assert_eq!(tally.right, 4000, "{kind:?} {tally:?}");
        }
    }
}

#[test]
fn no_wrong_pose_is_called_found_far_outside_the_workspace() {
    for (kind, half) in KINDS {
        let far = half.map(|h| 1.8 * h);
        let tally = tally(&samples::of_kind(kind, 0.02), far, 1.5, 4000);
        println!("{kind:?}, far: {tally:?}");
        assert_eq!(tally.wrong, 0, "{kind:?} {tally:?}");
        let solved = tally.right + tally.second_solution;
        assert!(solved >= 99 * (solved + tally.flagged) / 100, "{tally:?}");
    }
}

#[test]
fn with_six_cables_what_is_found_has_the_lengths() {
    let mut robot = samples::spatial(0.02);
    robot.cables.truncate(6);
    let tally = tally(&robot, [0.15; 3], 0.3, 2000);
    println!("six cables: {tally:?}");
    assert_eq!(tally.wrong, 0, "{tally:?}");
    assert!(tally.flagged <= 20, "{tally:?}");
}

#[test]
fn any_number_of_cables_from_the_free_coordinates_to_twelve() {
    use Coordinate::{Rz, X, Y, Z};
    let mut rng = samples::generator(32);
    for free in [&[X, Y][..], &[X, Y, Z], &[X, Y, Rz], &Coordinate::ALL] {
        for count in free.len()..=12 {
            let (robot, pose) = samples::anywhere(&mut rng, free, count);
            let lengths = lengths(&robot, &pose).unwrap();
            let solver = ForwardKinematics::new(&robot).unwrap();
            let start = random_pose(&mut rng, &robot, &pose, [0.005; 3], 0.005);
            let found = solver.solve(&lengths, &start);
            assert!(found.converged, "{found:?}");
            assert!(found.pose.difference(&pose).norm() < 1e-7, "{found:?}");
            assert_eq!(found.starts_used, 1);
        }
    }
}

#[test]
fn noise_moves_the_pose_as_far_as_least_squares_says() {
    let robot = samples::spatial(0.02);
    let noise_m = 1e-4;
    let solver = ForwardKinematics::new(&robot)
        .unwrap()
        .with_residual_limit(1e-3);
    let mut rng = samples::generator(33);
    let mut sum = 0.0;
    for _ in 0..500 {
        let pose = random_pose(&mut rng, &robot, &Pose::identity(), [0.15; 3], 0.1);
        let mut lengths = lengths(&robot, &pose).unwrap();
        for length in &mut lengths {
            *length += noise_m * rng.random_range(-1.0..1.0);
        }
        let start = random_pose(&mut rng, &robot, &pose, [0.005; 3], 0.005);
        let found = solver.solve(&lengths, &start);
        assert!(found.converged && found.starts_used == 1, "{found:?}");
        sum += found.residual_rms_m.powi(2);
    }
    // Uniform noise of variance s^2/3; 2 of 8 degrees of freedom are left in the residual.
    let expected = (noise_m * noise_m / 3.0 * 2.0 / 8.0).sqrt();
    let rms = (sum / 500.0_f64).sqrt();
    assert!((rms / expected - 1.0).abs() < 0.1, "{rms} {expected}");
}

#[test]
fn too_few_lengths_are_flagged_and_missing_ones_left_out() {
    let robot = samples::spatial(0.02);
    let solver = ForwardKinematics::new(&robot).unwrap();
    let pose = Pose::from_parts([0.02, 0.05, -0.1], [0.99, 0.05, -0.03, 0.08]);
    let start = Pose::from_parts([0.021, 0.05, -0.1], [0.99, 0.05, -0.03, 0.09]);
    let mut lengths = lengths(&robot, &pose).unwrap();
    lengths[2] = f64::NAN;
    let found = solver.solve(&lengths[..7], &start);
    assert!(found.converged && found.pose.difference(&pose).norm() < 1e-8);
    let found = solver.solve(&lengths[..5], &start);
    assert!(!found.converged && found.starts_used == 1);
    assert!(!solver.solve(&[], &start).converged);
    let nonsense = solver.solve(&[0.1, 5.0, 0.1, 5.0, 0.1, 5.0, 0.1, 5.0], &start);
    assert!(!nonsense.converged && nonsense.residual_rms_m > 0.1);
    assert!(!solver.solve(&[f64::INFINITY; 8], &start).converged);
}

#[test]
fn locked_coordinates_stay_as_in_the_start() {
    let robot = samples::planar(0.02);
    let solver = ForwardKinematics::new(&robot).unwrap();
    let pose = Pose::from_parts([0.1, -0.1, 0.02], [0.99, 0.0, 0.0, 0.1]);
    let start = Pose::from_parts([0.0, 0.0, 0.02], [1.0, 0.0, 0.0, 0.0]);
    let found = solver.solve(&lengths(&robot, &pose).unwrap(), &start);
    assert!(found.converged);
    assert!(found.pose.difference(&pose).norm() < 1e-9);
    assert_eq!(found.pose.position.z, 0.02);
}

#[test]
fn singular_pose_is_not_called_found() {
    // All cables in line with the platform's z axis: turning about it changes no length.
    let mut robot = samples::spatial(0.0);
    for cable in &mut robot.cables {
        cable.platform_anchor_m[0] = 0.0;
        cable.platform_anchor_m[1] = 0.0;
    }
    let solver = ForwardKinematics::new(&robot).unwrap();
    let pose = Pose::identity();
    let found = solver.solve(&lengths(&robot, &pose).unwrap(), &pose);
    assert!(!found.converged && found.conditioning < 1e-6, "{found:?}");
}

//! Tests of the inverse kinematics.

use super::super::samples::{self, Kind};
use super::*;
use crate::geometry::Coordinate;
use rand::RngExt;

fn length(robot: &Robot, pose: &Pose, cable: usize) -> f64 {
    inverse_kinematics(robot, pose).unwrap()[cable].length_m
}

/// Central difference of a cable's length when `change` is applied with +h and -h.
fn slope(robot: &Robot, pose: &Pose, i: usize, change: impl Fn(&mut Robot, &mut Pose, f64)) -> f64 {
    let h = 1e-6;
    let at = |s: f64| {
        let (mut robot, mut pose) = (robot.clone(), *pose);
        change(&mut robot, &mut pose, s);
        length(&robot, &pose, i)
    };
    (at(h) - at(-h)) / (2.0 * h)
}

fn check_gradients(robot: &Robot, pose: &Pose) {
    let near = |a: f64, b: f64| assert!((a - b).abs() < 5e-9, "{a} {b}");
    for (i, gradient) in length_gradients(robot, pose).unwrap().iter().enumerate() {
        for k in 0..6 {
            let twist = |s: f64| Twist::from_fn(|q, _| if q == k { s } else { 0.0 });
            let numeric = slope(robot, pose, i, |_, p, s| *p = p.perturbed(&twist(s)));
            near(gradient.pose[k], numeric);
        }
        for k in 0..3 {
            let numeric = slope(robot, pose, i, |r, _, s| {
                r.cables[i].pulley.entry_point_m[k] += s;
            });
            near(gradient.entry_point[k], numeric);
            let numeric = slope(robot, pose, i, |r, _, s| {
                r.cables[i].platform_anchor_m[k] += s;
            });
            near(gradient.platform_anchor[k], numeric);
            let numeric = slope(robot, pose, i, |r, _, s| {
                let axis = &mut r.cables[i].pulley.swivel_axis;
                let turn = nalgebra::Rotation3::new(Vec3::ith(k, s));
                *axis = (turn * Vec3::from(*axis)).into();
            });
            near(gradient.axis_rotation[k], numeric);
        }
        if robot.cables[i].pulley.radius_m > 0.0 {
            let numeric = slope(robot, pose, i, |r, _, s| r.cables[i].pulley.radius_m += s);
            near(gradient.radius, numeric);
        }
        let free = robot.platform.freedom();
        assert_eq!(gradient.pose_free(robot).len(), free.count());
    }
}

#[test]
fn gradients_match_finite_differences() {
    use Coordinate::{Rz, X, Y, Z};
    let mut rng = samples::generator(11);
    for count in 1..=12 {
        for free in [&Coordinate::ALL[..], &[X, Y, Rz], &[X, Y, Z], &[X, Y]] {
            let (robot, pose) = samples::anywhere(&mut rng, free, count);
            check_gradients(&robot, &pose);
        }
    }
    for kind in [Kind::Spatial, Kind::Planar, Kind::PointMass] {
        for radius in [0.0, 0.02] {
            let robot = samples::of_kind(kind, radius);
            let twist = Twist::from_fn(|_, _| rng.random_range(-0.1..0.1));
            check_gradients(&robot, &Pose::identity().perturbed(&twist));
        }
    }
}

#[test]
fn eyelet_length_is_the_distance() {
    let mut rng = samples::generator(12);
    for _ in 0..50 {
        let (mut robot, pose) = samples::anywhere(&mut rng, &Coordinate::ALL, 4);
        for cable in &mut robot.cables {
            cable.pulley.radius_m = 0.0;
        }
        for (cable, state) in robot
            .cables
            .iter()
            .zip(inverse_kinematics(&robot, &pose).unwrap())
        {
            let anchor = pose.transform(&Vec3::from(cable.platform_anchor_m));
            let distance = (anchor - Vec3::from(cable.pulley.entry_point_m)).norm();
            assert!((state.length_m - distance).abs() < 1e-14);
            assert!((state.free_length_m - distance).abs() < 1e-14);
        }
    }
}

#[test]
fn swivel_angle_is_right_handed_about_the_axis() {
    let mut robot = samples::spatial(0.02);
    robot.cables.truncate(1);
    let pulley = &mut robot.cables[0].pulley;
    pulley.entry_point_m = [0.0; 3];
    pulley.swivel_zero = Some([2.0, 0.0, 0.5]);
    for (axis, sign) in [([0.0, 0.0, 1.0], 1.0), ([0.0, 0.0, -1.0], -1.0)] {
        robot.cables[0].pulley.swivel_axis = axis;
        for angle in [-3.0_f64, -1.0, 0.2, 2.5] {
            let target = Vec3::new(angle.cos(), angle.sin(), 0.3);
            let mut pose = Pose::identity();
            pose.position = target - Vec3::from(robot.cables[0].platform_anchor_m);
            let state = &inverse_kinematics(&robot, &pose).unwrap()[0];
            assert!((state.swivel_rad.unwrap() - sign * angle).abs() < 1e-12);
        }
    }
    robot.cables[0].pulley.swivel_zero = Some([0.0, 0.0, 1.0]);
    let error = inverse_kinematics(&robot, &Pose::from_parts([1.0; 3], [1.0, 0.0, 0.0, 0.0]));
    let cable = robot.cables[0].name.clone();
    assert_eq!(error, Err(KinematicsError::SwivelZeroAlongAxis { cable }));
}

/// What one cable with entry point 0 and axis +z says about an anchor.
fn verdict(radius: f64, anchor: [f64; 3]) -> Result<Vec<CableState>, KinematicsError> {
    let cable = samples::cable("winch 3", Vec3::zeros(), Vec3::z(), radius, Vec3::zeros());
    let robot = samples::robot(&Coordinate::ALL, vec![cable]);
    inverse_kinematics(&robot, &Pose::from_parts(anchor, [1.0, 0.0, 0.0, 0.0]))
}

#[test]
fn impossible_poses_are_named() {
    let text = |r: Result<Vec<CableState>, KinematicsError>| r.unwrap_err().to_string();
    assert_eq!(
        text(verdict(0.1, [0.12, 0.01, 0.02])),
        "the platform anchor of winch 3 is inside its pulley"
    );
    assert_eq!(
        text(verdict(0.1, [0.0, 0.0, 1.0])),
        "the platform anchor of winch 3 is on the swivel axis of its pulley"
    );
    assert_eq!(
        text(verdict(0.0, [0.0; 3])),
        "the platform anchor of winch 3 is at its entry point"
    );
    assert_eq!(
        text(verdict(0.1, [0.05, 0.0, -1.0])),
        "winch 3 would wrap more than half a turn around its pulley"
    );
    assert!(verdict(0.1, [f64::NAN, 0.0, 1.0]).is_err());
    let on_axis = verdict(0.0, [0.0, 0.0, -1.5]).unwrap();
    assert!((on_axis[0].length_m - 1.5).abs() < 1e-15);
    assert!((on_axis[0].toward_exit - Vec3::z()).norm() < 1e-15);
}

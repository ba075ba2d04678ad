//! Measurements that tell causes apart.

use super::super::report::Cause;
use super::super::separation::separation;
use super::{Fit, problem_at_fitted_poses, run_with, setting};
use crate::effect::{BoundEffect, EffectRequest};
use crate::robot::Robot;

fn cause(robot: &Robot, request: &str) -> Cause {
    let instances = EffectRequest::parse(request).unwrap().bind(robot).unwrap();
    Cause { instances }
}

/// An event at the last pose: a slip of the cable and a wrong reading are the same until another pose is measured.
#[test]
fn one_pose_distinguishes_a_slip_from_a_wrong_reading() {
    let hidden = setting(
        "cable_slip",
        &["cable-2"],
        &[("step", 0.02), ("pose", 20.0)],
    );
    let run = run_with("mini", 20, 95, &[hidden]);
    let base = problem_at_fitted_poses(&run.dataset);
    let [slip, reading] = [
        "cable_slip:cable-2:pose=20",
        "encoder_outlier:cable-2:pose=20",
    ]
    .map(|request| Fit::new(&base, &[cause(&run.dataset.robot, request)]).unwrap());
    let separate = (slip.solution.chi2 - reading.solution.chi2).abs();
    assert!(separate < 1.0, "{separate}");
    let found = separation(&slip, &reading).unwrap();
    assert_eq!(found.poses.len(), 5);
    assert!(found.expected_delta_chi2 > 100.0);
    let expected = "Measure the platform once, at the first of the poses listed: there these causes differ most. \
        Or check, without measuring: Go back to the first pose half-way and at the end, and compare the readings. \
        Go to that pose again and compare the readings.";
    assert_eq!(found.advice, expected);
}

/// No pose can tell apart two names for the same model.
#[test]
fn no_poses_are_proposed_if_none_would_help() {
    let hidden = setting("winch_scale_common", &[], &[("scale", 0.01)]);
    let run = run_with("mini", 20, 96, &[hidden]);
    let base = problem_at_fitted_poses(&run.dataset);
    let common = cause(&run.dataset.robot, "winch_scale_common");
    let each = cause(&run.dataset.robot, "winch_scale:cable-1");
    let same = Cause {
        instances: vec![BoundEffect {
            cables: (0..8).collect(),
            ..each.instances[0].clone()
        }],
    };
    let [one, other] = [common, same].map(|cause| Fit::new(&base, &[cause]).unwrap());
    let found = separation(&one, &other).unwrap();
    assert!(found.poses.is_empty());
    assert_eq!(found.expected_delta_chi2, 0.0);
    let expected = "No poses of this workspace tell these causes apart, but a check does: \
        Measure one distance between two poses of the platform with a steel tape. \
        Pay out a few metres of cable and compare what the controller counts with a steel tape.";
    assert_eq!(found.advice, expected);
}

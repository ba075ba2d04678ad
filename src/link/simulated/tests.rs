//! Tests of the simulated robot by itself.

use std::sync::Arc;

use tautline_core::geometry::Twist;
use tautline_core::robot::presets;
use tautline_core::simulation::{SimulationOptions, TrueGeometry, true_robot};

use super::*;
use crate::clock::ManualClock;
use crate::controller::Instrument;

fn robot(change: impl FnOnce(&mut SimulatedSetup)) -> (SimulatedRobot, ManualClock) {
    let preset = presets::find("mini").unwrap();
    let mut setup = SimulatedSetup::of_preset(&preset, 1);
    change(&mut setup);
    let clock = ManualClock::default();
    let robot = SimulatedRobot::new(setup, Arc::new(clock.clone())).unwrap();
    (robot, clock)
}

fn armed(change: impl FnOnce(&mut SimulatedSetup)) -> (SimulatedRobot, ManualClock) {
    let (mut robot, clock) = robot(change);
    robot.connect().unwrap();
    robot.arm().unwrap();
    (robot, clock)
}

fn target() -> Pose {
    Pose::identity().perturbed(&Twist::new(0.1, -0.08, 0.05, 0.0, 0.1, -0.05))
}

fn position_error_m(robot: &SimulatedRobot, target: &Pose) -> f64 {
    (robot.true_pose().position - target.position).norm()
}

#[test]
fn everything_can_go_to_another_thread() {
    fn sendable<T: Send>() {}
    sendable::<SimulatedRobot>();
    sendable::<SimulatedTracker>();
    sendable::<crate::measuring::MeasuringRun>();
    sendable::<crate::verifying::VerifyingRun>();
    sendable::<crate::GuardedController<dyn Controller>>();
}

#[test]
fn nothing_moves_or_is_written_unless_armed() {
    let (mut robot, clock) = robot(|_| ());
    assert_eq!(robot.state().activity, Activity::Disconnected);
    assert!(robot.sample().unwrap_err().is_disconnection());
    robot.connect().unwrap();
    let value = [("home.x_m".to_owned(), 0.1)];
    assert_eq!(robot.command(&target()), Err(LinkError::NotArmed));
    assert_eq!(robot.home(), Err(LinkError::NotArmed));
    assert_eq!(robot.write(&value), Err(LinkError::NotArmed));
    robot.arm().unwrap();
    robot.command(&target()).unwrap();
    assert_eq!(robot.state().activity, Activity::Moving);
    let refused = robot.write(&value).unwrap_err().to_string();
    assert!(refused.contains("stands still"), "{refused}");
    clock.advance(0.5);
    // The connection takes the arming with it, and the drives stop.
    robot.set_faults(vec![Fault::ConnectionLost]);
    let stopped = robot.true_pose();
    clock.advance(5.0);
    assert_eq!(robot.true_pose(), stopped);
    assert!(robot.connect().unwrap_err().is_disconnection());
    robot.set_faults(Vec::new());
    robot.connect().unwrap();
    assert!(!robot.state().armed);
}

#[test]
fn goes_where_its_parameters_lead() {
    let (mut robot, clock) = armed(|_| ());
    robot.command(&target()).unwrap();
    clock.advance(10.0);
    assert_eq!(robot.state().activity, Activity::Still);
    let before = position_error_m(&robot, &target());
    assert!(before > 2e-4, "{before}");
    let truth = parameters_of(robot.real.truth());
    let values: Vec<_> = truth.into_iter().map(|p| (p.name, p.value)).collect();
    robot.write(&values).unwrap();
    robot.command(&target()).unwrap();
    clock.advance(10.0);
    let after = position_error_m(&robot, &target());
    assert!(after < 1e-8, "{after}");
}

#[test]
fn a_corrected_effect_moves_the_platform_back() {
    let setting = |scale: f64| tautline_core::effect::EffectSetting {
        effect: "winch_scale".into(),
        targets: vec!["cable-3".into()],
        parameters: [("scale".to_owned(), scale)].into(),
    };
    let (mut robot, clock) = armed(|setup| {
        setup.truth = setup.nominal.clone();
        setup.truth.effects = vec![setting(0.02)];
        setup.nominal.effects = vec![setting(0.0)];
    });
    robot.command(&target()).unwrap();
    clock.advance(10.0);
    assert!(position_error_m(&robot, &target()) > 2e-4);
    let name = "effect.winch_scale.cable-3.scale".to_owned();
    robot.write(&[(name, 0.02)]).unwrap();
    robot.command(&target()).unwrap();
    clock.advance(10.0);
    assert!(position_error_m(&robot, &target()) < 1e-8);
}

#[test]
fn homing_zeroes_the_encoders_where_the_platform_truly_is_at_home() {
    let (mut robot, clock) = armed(|_| ());
    robot.command(&target()).unwrap();
    clock.advance(10.0);
    assert!(
        robot
            .sample()
            .unwrap()
            .revolutions
            .iter()
            .any(|r| r.abs() > 0.1)
    );
    robot.home().unwrap();
    clock.advance(10.0);
    let home = robot.real.truth().home.unwrap().pose();
    assert!(robot.true_pose().difference(&home).amax() < 1e-12);
    assert_eq!(robot.sample().unwrap().revolutions, vec![0.0; 8]);
}

#[test]
fn averaged_noise_is_that_of_the_description() {
    // 400 visits of two poses. The variance of the mean of 10 samples has a relative standard deviation of
    // sqrt(2 / 399) = 7.1 %; the limit of 36 % is at 5 of them: a false failure has probability 6e-7 per channel.
    let (mut robot, clock) = armed(|setup| {
        setup.truth = setup.nominal.clone();
        setup.averaged_samples = 10;
    });
    let exact = {
        let data = robot.rest_for(&target(), moment(1, 0.0)).unwrap().readings;
        [
            data.revolutions.get(0, 2),
            data.force_n.get(0, 2),
            data.laser_at(0),
        ]
    };
    let sd = [
        5e-5 / robot.setup.nominal.cables[2].winch.cable_per_revolution_m(),
        2.0,
        3e-4,
    ];
    let mut squares = [0.0; 3];
    for _ in 0..400 {
        robot.command(&target()).unwrap();
        clock.advance(10.0);
        let mut mean = [0.0; 3];
        for _ in 0..10 {
            let sample = robot.sample().unwrap();
            let read = [
                sample.revolutions[2],
                sample.force_n[2],
                sample.laser_m.unwrap(),
            ];
            for k in 0..3 {
                mean[k] += 0.1 * (read[k] - exact[k]);
            }
        }
        for k in 0..3 {
            squares[k] += (mean[k] / sd[k]).powi(2) / 400.0;
        }
    }
    for ratio in squares {
        assert!((ratio - 1.0).abs() < 0.36, "{squares:?}");
    }
}

#[test]
fn the_same_seed_gives_the_same_run() {
    let run = || {
        let (mut robot, clock) = armed(|_| ());
        robot.command(&target()).unwrap();
        (0..20)
            .map(|_| {
                clock.advance(0.2);
                robot.sample().unwrap()
            })
            .collect::<Vec<_>>()
    };
    assert_eq!(run(), run());
}

#[test]
fn the_laser_has_no_return_outside_its_range() {
    let (mut robot, clock) = armed(|setup| setup.laser_range_m = [0.4, 0.5]);
    assert!(robot.sample().unwrap().laser_m.is_some());
    robot.command(&target()).unwrap();
    clock.advance(10.0);
    let distance = robot.sample().unwrap().laser_m;
    assert!(distance.is_none_or(|d| (0.4..=0.5).contains(&d)));
    let high = Pose::identity().perturbed(&Twist::new(0.0, 0.0, 0.15, 0.0, 0.0, 0.0));
    robot.command(&high).unwrap();
    clock.advance(10.0);
    assert_eq!(robot.sample().unwrap().laser_m, None);
}

#[test]
fn speed_makes_its_time_run_faster() {
    let (mut robot, clock) = armed(|setup| setup.speed = 20.0);
    robot.command(&target()).unwrap();
    clock.advance(0.2);
    assert_eq!(robot.state().activity, Activity::Still);
    assert_eq!(robot.sample().unwrap().time_s, 4.0);
}

#[test]
fn the_tracker_sees_the_true_pose() {
    let (mut robot, clock) = armed(|_| ());
    let mut tracker = robot.tracker(0.0, 0.0, 3);
    robot.command(&target()).unwrap();
    clock.advance(10.0);
    let seen = tracker.measure().unwrap();
    assert_eq!(
        Pose::from_parts(seen.position_m, [1.0, 0.0, 0.0, 0.0]).position,
        robot.true_pose().position
    );
}

#[test]
fn impossible_poses_and_robots_are_refused_in_words() {
    let (mut robot, _) = armed(|_| ());
    let far = Pose::identity().perturbed(&Twist::new(3.0, 0.0, 0.0, 0.0, 0.0, 0.0));
    assert!(matches!(robot.command(&far), Err(LinkError::Refused(_))));
    let preset = presets::find("mini").unwrap();
    let mut setup = SimulatedSetup::of_preset(&preset, 1);
    setup.truth.home = None;
    let refused = SimulatedRobot::new(setup, Arc::new(ManualClock::default()));
    let text = refused.err().unwrap().to_string();
    assert!(text.contains("no home pose"), "{text}");
}

#[test]
fn a_given_truth_is_that_of_a_simulated_run() {
    let preset = presets::find("hall").unwrap();
    let mut options = SimulationOptions::new(2, 9);
    let drawn = true_robot(&preset.robot, &options);
    let run = tautline_core::simulation::simulate(&preset.robot, &options).unwrap();
    assert_eq!(drawn, run.truth);
    options.geometry = TrueGeometry::Nominal;
    assert_eq!(true_robot(&preset.robot, &options), preset.robot);
}

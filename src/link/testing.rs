//! Runs of simulated robots for the tests of this crate.

use std::sync::Arc;

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use tautline_core::estimation::{Problem, Solution, solve};
use tautline_core::geometry::Pose;
use tautline_core::measurement::{Dataset, Measurements};
use tautline_core::robot::presets::{self, Preset};

use crate::clock::{Clock, ManualClock};
use crate::controller::Controller;
use crate::measuring::{MeasuringEvent, MeasuringOptions, MeasuringRun};
use crate::simulated::{SimulatedRobot, SimulatedSetup};
use crate::{GuardedController, Limits};

pub(crate) fn preset(name: &str) -> Preset {
    presets::find(name).unwrap()
}

pub(crate) fn limits(preset: &Preset) -> Limits {
    Limits {
        robot: preset.robot.clone(),
        workspace: preset.workspace,
        tension: preset.tension,
    }
}

/// An armed robot behind its limits, and its clock.
pub(crate) fn armed(
    preset: &Preset,
    change: impl FnOnce(&mut SimulatedSetup),
) -> (GuardedController<SimulatedRobot>, ManualClock) {
    let mut setup = SimulatedSetup::of_preset(preset, 4);
    change(&mut setup);
    let clock = ManualClock::default();
    let robot = SimulatedRobot::new(setup, Arc::new(clock.clone())).unwrap();
    let mut robot = GuardedController::new(Box::new(robot), limits(preset));
    robot.connect().unwrap();
    robot.arm().unwrap();
    (robot, clock)
}

/// Home and random poses within the limits.
pub(crate) fn plan(preset: &Preset, poses: usize, seed: u64) -> Vec<(i64, Pose)> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let home = preset.robot.home.unwrap().pose();
    let limits = limits(preset);
    let drawn = std::iter::repeat_with(|| preset.workspace.draw(&preset.robot, &mut rng));
    let possible = drawn.filter(|pose| limits.check_pose(pose).is_ok());
    let poses: Vec<Pose> = std::iter::once(home).chain(possible.take(poses)).collect();
    (0..).zip(poses).collect()
}

pub(crate) fn run_of(preset: &Preset, poses: usize, seed: u64) -> MeasuringRun {
    let mut options = MeasuringOptions::of(&preset.robot);
    options.tension = preset.tension;
    MeasuringRun::new(plan(preset, poses, seed), &preset.robot, options)
}

/// Ticks every 50 ms and confirms measured poses, until the run pauses or ends.
pub(crate) fn drive(
    run: &mut MeasuringRun,
    robot: &mut dyn Controller,
    clock: &ManualClock,
) -> Vec<MeasuringEvent> {
    let mut events = Vec::new();
    for _ in 0..100_000 {
        clock.advance(0.05);
        for event in run.tick(robot, clock.now_s()) {
            if let MeasuringEvent::Measured(pose) = &event {
                run.confirm_stored(pose.label());
            }
            let stops = matches!(
                event,
                MeasuringEvent::Finished
                    | MeasuringEvent::Failed(_)
                    | MeasuringEvent::Paused { .. }
            );
            events.push(event);
            if stops {
                return events;
            }
        }
    }
    panic!("the run does not end");
}

/// Measured readings, one row per pose.
pub(crate) fn readings(events: &[MeasuringEvent]) -> Measurements {
    let mut readings = Measurements::default();
    for event in events {
        if let MeasuringEvent::Measured(pose) = event {
            readings.append(pose.readings.clone());
        }
    }
    readings
}

pub(crate) fn warnings(events: &[MeasuringEvent]) -> Vec<String> {
    let warned = events.iter().filter_map(|event| match event {
        MeasuringEvent::Warning(warning) => Some(warning.text.clone()),
        _ => None,
    });
    warned.collect()
}

/// Words of the warning of a tension outside the limits, which a sound robot may cause at the border of its workspace.
pub(crate) const OUTSIDE_LIMITS: &str = "its tension is too";

/// Measures home and poses without any trouble.
pub(crate) fn measured(
    preset: &Preset,
    poses: usize,
    robot: &mut dyn Controller,
    clock: &ManualClock,
) -> Dataset {
    let events = drive(&mut run_of(preset, poses, 11), robot, clock);
    assert_eq!(events.last(), Some(&MeasuringEvent::Finished));
    let (tensions, others): (Vec<_>, Vec<_>) = warnings(&events)
        .into_iter()
        .partition(|text| text.contains(OUTSIDE_LIMITS));
    assert_eq!(others, Vec::<String>::new());
    assert!(tensions.len() <= 1, "{tensions:?}");
    let measurements = readings(&events);
    assert_eq!(measurements.len(), poses + 1);
    Dataset {
        robot: preset.robot.clone(),
        measurements,
    }
}

pub(crate) fn identified(data: &Dataset) -> Solution {
    solved(&Problem::new(data).unwrap())
}

pub(crate) fn solved(problem: &Problem<'_>) -> Solution {
    let options = tautline_core::estimation::Options::default();
    let solution = solve(problem, &options, &mut |_| {
        tautline_core::estimation::Control::Continue
    });
    let solution = solution.unwrap();
    assert!(solution.converged());
    solution
}

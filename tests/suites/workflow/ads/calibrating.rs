//! A calibration from the first pose to the verification, through real frames.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use tautline_core::estimation::{Control, Options, Problem, Solution, solve};
use tautline_core::geometry::Pose;
use tautline_core::measurement::{Dataset, Measurements};
use tautline_link::adjusting::{ControllerValues, plan_adjustment, write_adjustment};
use tautline_link::measuring::{MeasuringEvent, MeasuringOptions, MeasuringRun};
use tautline_link::verifying::{
    CheckTarget, VerifyingEvent, VerifyingOptions, VerifyingRun, cube_poses,
};
use tautline_link::{Clock, Controller, Instrument, Limits, SystemClock};

use tautline_validation::support::ads::Plant;
use tautline_validation::support::ads::symbols::Style;

/// Poses without the home pose.
const POSES: usize = 10;
/// Ticks after which a run must have ended.
const TICKS: usize = 200_000;

fn poses(plant: &Plant) -> Vec<(i64, Pose)> {
    let preset = &plant.preset;
    let limits = Limits {
        robot: preset.robot.clone(),
        workspace: preset.workspace,
        tension: preset.tension,
    };
    let home = preset.robot.home.expect("a home pose").pose();
    let mut rng = ChaCha8Rng::seed_from_u64(11);
    let drawn = std::iter::repeat_with(|| preset.workspace.draw(&preset.robot, &mut rng));
    let possible = drawn.filter(|pose| limits.check_pose(pose).is_ok());
    (0..)
        .zip(std::iter::once(home).chain(possible.take(POSES)))
        .collect()
}

fn measure(plant: &Plant, controller: &mut dyn Controller) -> Dataset {
    let robot = &plant.preset.robot;
    let mut options = MeasuringOptions::of(robot);
    options.tension = plant.preset.tension;
    let poses = poses(plant);
    let expected = poses.len();
    let mut run = MeasuringRun::new(poses, robot, options);
    let clock = SystemClock::start();
    let mut measurements = Measurements::default();
    for _ in 0..TICKS {
        for event in run.tick(controller, clock.now_s()) {
            match event {
                MeasuringEvent::Measured(pose) => {
                    run.confirm_stored(pose.label());
                    measurements.append(pose.readings);
                }
                MeasuringEvent::Finished => {
                    assert_eq!(measurements.len(), expected);
                    return Dataset {
                        robot: robot.clone(),
                        measurements,
                    };
                }
                MeasuringEvent::Failed(text) => panic!("{text}"),
                MeasuringEvent::Paused { reason, .. } => panic!("{reason}"),
                _ => {}
            }
        }
    }
    panic!("the run does not end");
}

fn identify(data: &Dataset) -> Solution {
    let problem = Problem::new(data).expect("a problem");
    let solution = solve(&problem, &Options::default(), &mut |_| Control::Continue);
    let solution = solution.expect("a solution");
    assert!(solution.converged());
    solution
}

/// Mean distance of the targets from where the platform was (m).
fn verify(
    targets: &[CheckTarget],
    controller: &mut dyn Controller,
    instrument: &mut dyn Instrument,
) -> f64 {
    let options = VerifyingOptions {
        cycles: 1,
        measurements: 1,
        ..VerifyingOptions::default()
    };
    let mut run = VerifyingRun::new(targets.to_vec(), options);
    let mut misses = Vec::new();
    for _ in 0..TICKS {
        match run.tick(controller, instrument) {
            Some(VerifyingEvent::Attained(row)) => {
                let commanded = nalgebra::Vector3::from(row.commanded.position_m);
                let attained = nalgebra::Vector3::from(row.attained.position_m);
                misses.push((attained - commanded).norm());
            }
            Some(VerifyingEvent::Finished) => {
                assert_eq!(misses.len(), targets.len());
                return misses.iter().sum::<f64>() / misses.len() as f64;
            }
            Some(VerifyingEvent::Failed(text)) => panic!("{text}"),
            _ => {}
        }
    }
    panic!("the run does not end");
}

fn calibrate(style: Style) {
    let mut plant = Plant::changed(style, |setup| {
        setup.noise = false;
        setup.truth.home = setup.nominal.home;
    });
    let mut tracker = plant.tracker();
    let mut robot = plant.armed();
    let targets = cube_poses(&plant.preset.robot, &plant.preset.workspace);
    let targets = &targets[..5];
    let data = measure(&plant, &mut robot);
    let before = verify(targets, &mut robot, &mut tracker);
    let model = identify(&data).globals.model(&plant.preset.robot);
    let plan = plan_adjustment(&robot.parameters().expect("parameters"), &model, None);
    assert!(
        plan.iter()
            .all(|difference| difference.controller.is_some())
    );
    let changes = plan.iter().filter(|d| d.is_writable_change());
    let values: Vec<_> = changes
        .filter_map(|d| Some((d.name.clone(), d.identified?)))
        .collect();
    assert!(values.len() > 20, "{}", values.len());
    let adjustment = write_adjustment(&mut robot, &values).expect("written");
    assert_eq!(adjustment.holds, ControllerValues::New, "{adjustment:?}");
    let after = verify(targets, &mut robot, &mut tracker);
    assert!(before > 5e-4 && after < 0.4 * before, "{before} {after}");
}

#[test]
fn with_arrays() {
    calibrate(Style::Arrays);
}

#[test]
fn with_one_symbol_per_value() {
    calibrate(Style::Single);
}

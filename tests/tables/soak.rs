//! Memory of a measuring run of very many poses with random faults, which an operator answers.

use std::sync::Arc;

use anyhow::{Context, Result};
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use tautline_core::geometry::Pose;
use tautline_core::robot::presets;
use tautline_link::measuring::{MeasuringEvent, MeasuringOptions, MeasuringRun};
use tautline_link::simulated::{Fault, SimulatedRobot, SimulatedSetup};
use tautline_link::{Activity, Clock, Controller, GuardedController, Limits, ManualClock};
use tautline_session::{RecoveryWriter, Session, Timestamp};

use crate::support::process::{IN_USE, memory_mib};

/// Seed of the run.
pub const SEED: u64 = 52_000;
/// Share of the poses after which a fault begins.
const FAULTY: f64 = 0.1;
/// Number of pauses at one pose after which the operator leaves it out.
const PATIENCE: usize = 3;
/// Number of measured poses between two readings of the memory.
const STEP: usize = 100;

/// What a run took.
#[derive(Debug, Clone, Default)]
pub struct Soak {
    measured: usize,
    skipped: usize,
    faults: usize,
    /// Series after the first one.
    series: usize,
    /// Number of times that the operator had to decide, or a run had to be begun anew.
    stops: usize,
    /// Memory in use after each hundred poses (MiB).
    memory_mib: Vec<f64>,
}

fn fault(rng: &mut impl Rng) -> Fault {
    let cable = rng.random_range(0..8);
    let tension = |reading_n| Fault::Tension { cable, reading_n };
    match rng.random_range(0..8) {
        0 => Fault::LaserLost,
        1 => Fault::NotANumber { cable },
        2 => Fault::Jump {
            cable,
            revolutions: 0.5,
        },
        3 => Fault::Restless {
            cable,
            revolutions_per_s: 0.05,
        },
        4 => tension(0.0),
        5 => tension(400.0),
        6 => Fault::ForceFactor {
            cable,
            factor: f64::NAN,
        },
        _ => Fault::ConnectionLost,
    }
}

/// Measures so many poses of MINI (Linux).
///
/// # Errors
/// If the simulated robot cannot be driven at all, or nothing can be written.
pub fn study(poses: usize, seed: u64) -> Result<Soak> {
    let preset = presets::find("mini").context("a preset")?;
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let limits = Limits::of(&preset.robot);
    let home = preset.robot.home.context("a home pose")?.pose();
    let drawn = std::iter::repeat_with(|| preset.workspace.draw(&preset.robot, &mut rng));
    let held = drawn.filter(|pose| limits.check_pose(pose).is_ok());
    let mut plan: Vec<(i64, Pose)> = (0..)
        .zip(std::iter::once(home).chain(held.take(poses)))
        .collect();
    let clock = ManualClock::default();
    let setup = SimulatedSetup::of_preset(&preset, seed);
    let robot = SimulatedRobot::new(setup, Arc::new(clock.clone()))?;
    let mut robot = GuardedController::new(Box::new(robot), limits);
    robot.connect()?;
    robot.arm()?;
    let folder = tempfile::tempdir()?;
    let mut session = Session::new(
        "soak",
        preset.robot.clone(),
        Timestamp::from_unix_seconds(0),
    );
    let mut writer = RecoveryWriter::create(folder.path(), None, &session)?;
    let begin = |plan: &[(i64, Pose)], session: &Session| {
        let options = MeasuringOptions::of(&preset.robot);
        MeasuringRun::new(plan.to_vec(), &preset.robot, options)
            .continuing(&session.measurements.labels)
    };
    let mut run = begin(&plan, &session);
    let mut soak = Soak::default();
    let mut tried = (0, 0);
    loop {
        clock.advance(0.05);
        for event in run.tick(&mut robot, clock.now_s()) {
            match event {
                MeasuringEvent::Measured(pose) => {
                    writer.append_pose(&pose)?;
                    session.append_pose(&pose).map_err(anyhow::Error::msg)?;
                    run.confirm_stored(pose.label());
                    soak.measured += 1;
                    if soak.measured % STEP == 0 {
                        soak.memory_mib
                            .push(memory_mib(std::process::id(), IN_USE)?);
                    }
                    if rng.random_bool(FAULTY) {
                        soak.faults += 1;
                        robot.inner_mut().set_faults(vec![fault(&mut rng)]);
                    }
                }
                MeasuringEvent::Paused { .. } | MeasuringEvent::Failed(_) => {
                    soak.stops += 1;
                    robot.inner_mut().set_faults(Vec::new());
                    if robot.state().activity == Activity::Disconnected {
                        robot.connect()?;
                    }
                    robot.arm()?;
                    let label = run.under_way().unwrap_or_default();
                    tried = if tried.0 == label {
                        (label, tried.1 + 1)
                    } else {
                        (label, 1)
                    };
                    match event {
                        // The encoders have lost their zero: the rest is another series, with a home pose of its own.
                        MeasuringEvent::Failed(_) if tried.1 > PATIENCE => {
                            let measured = std::mem::take(&mut session.measurements).labels;
                            plan.retain(|(label, _)| *label == 0 || !measured.contains(label));
                            writer = RecoveryWriter::create(folder.path(), None, &session)?;
                            soak.series += 1;
                            tried = (0, 0);
                            run = begin(&plan, &session);
                        }
                        MeasuringEvent::Failed(_) => run = begin(&plan, &session),
                        _ if tried.1 > PATIENCE => {
                            soak.skipped += 1;
                            run.skip();
                        }
                        _ => run.resume(),
                    }
                }
                MeasuringEvent::Finished => return Ok(soak),
                _ => {}
            }
        }
    }
}

/// What was measured, and the memory.
#[must_use]
pub fn markdown(soak: &Soak) -> String {
    let memory = soak.memory_mib.iter().map(|mib| format!("{mib:.0}"));
    format!(
        "{} poses measured, {} left out, {} faults, {} stops, {} series; memory after each {STEP} poses, MiB: {}\n",
        soak.measured,
        soak.skipped,
        soak.faults,
        soak.stops,
        soak.series + 1,
        memory.collect::<Vec<_>>().join(", ")
    )
}

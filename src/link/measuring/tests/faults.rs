//! Detection and naming of faults of instruments on three robots, and false alarms on sound robots.

use tautline_core::measurement::Measurements;
use tautline_core::robot::presets::Preset;

use super::*;
use crate::clock::{Clock, ManualClock};
use crate::guarded::GuardedController;
use crate::simulated::{Fault, SimulatedRobot};
use crate::testing::{OUTSIDE_LIMITS, armed, preset, run_of};

const ROBOTS: [&str; 3] = ["mini", "suspended", "planar"];
/// The cable that is at fault, and another one.
const CABLE: usize = 1;
const OTHER: usize = 3;

/// Makes a fault of the pose before it begins.
type MakeFault = fn(&Preset, &Measurements) -> Fault;

/// Name of a fault, function that makes it from the pose before it begins, and words that have to be in the warning.
struct Case {
    name: &'static str,
    fault: MakeFault,
    words: &'static str,
}

fn case(name: &'static str, words: &'static str, fault: MakeFault) -> Case {
    Case { name, fault, words }
}

fn encoder(factor: f64) -> Fault {
    Fault::EncoderFactor {
        cable: CABLE,
        factor,
    }
}

fn force(factor: f64) -> Fault {
    Fault::ForceFactor {
        cable: CABLE,
        factor,
    }
}

fn laser(factor: f64, by_m: f64) -> Fault {
    Fault::LaserOff { factor, by_m }
}

/// Faults of encoders.
fn encoders() -> Vec<Case> {
    vec![
        case(
            "encoder shows no number",
            "encoder shows no number",
            |_, _| Fault::NotANumber { cable: CABLE },
        ),
        case("encoder stuck", "exactly the same", |_, at| {
            Fault::StuckEncoder {
                cable: CABLE,
                revolutions: at.revolutions.get(0, CABLE),
            }
        }),
        case(
            "encoder off by three times what is plausible",
            "off what is expected",
            |preset, _| {
                let plausible_m = MeasuringOptions::of(&preset.robot).plausible_m;
                let winch = preset.robot.cables[CABLE].winch;
                Fault::Jump {
                    cable: CABLE,
                    revolutions: 3.0 * plausible_m / winch.cable_per_revolution_m(),
                }
            },
        ),
        case(
            "encoder reversed",
            "against the expected direction",
            |_, _| Fault::Reversed { cable: CABLE },
        ),
        case("encoder in degrees", "times what is expected", |_, _| {
            encoder(360.0)
        }),
        case(
            "encoder with twice the gear",
            "times what is expected",
            |_, _| encoder(2.0),
        ),
        case(
            "encoder with half the gear",
            "times what is expected",
            |_, _| encoder(0.5),
        ),
        case(
            "encoders exchanged",
            "encoder follows the motion of the other",
            |_, _| Fault::Exchanged {
                cables: [CABLE, OTHER],
            },
        ),
        case(
            "winch never at rest",
            "does not come to rest",
            |preset, _| {
                let rate_m_per_s = MeasuringOptions::of(&preset.robot).still.length_m_per_s;
                let winch = preset.robot.cables[CABLE].winch;
                Fault::Restless {
                    cable: CABLE,
                    revolutions_per_s: 2.0 * rate_m_per_s / winch.cable_per_revolution_m(),
                }
            },
        ),
    ]
}

/// Faults of force sensors.
fn forces() -> Vec<Case> {
    vec![
        case(
            "force shows no number",
            "force sensor shows no number",
            |_, _| force(f64::NAN),
        ),
        case("force stuck", "exactly the same", |_, at| Fault::Tension {
            cable: CABLE,
            reading_n: at.force_n.get(0, CABLE),
        }),
        case("force reversed", "a cable cannot push", |_, _| force(-1.0)),
        case("force twice", "times the tension that holds", |_, _| {
            force(2.0)
        }),
        case("force half", "times the tension that holds", |_, _| {
            force(0.5)
        }),
        case("force in millinewtons", "pulls with", |_, _| force(1000.0)),
        case("forces exchanged", "force readings swapped", |_, _| {
            Fault::ForcesExchanged {
                cables: [CABLE, OTHER],
            }
        }),
    ]
}

/// Faults of the laser and of the time.
fn others() -> Vec<Case> {
    vec![
        case("laser without return", "the laser has no return", |_, _| {
            Fault::LaserLost
        }),
        case(
            "laser shows no number",
            "the laser has no return",
            |_, _| laser(f64::NAN, 0.0),
        ),
        case("laser stuck", "laser shows exactly the same", |_, at| {
            Fault::LaserStuck {
                distance_m: at.laser_at(0),
            }
        }),
        case(
            "laser off by three times what is plausible",
            "the laser distance is",
            |preset, _| laser(1.0, 3.0 * MeasuringOptions::of(&preset.robot).plausible_m),
        ),
        case(
            "laser in millimetres",
            "times the distance that is expected",
            |_, _| laser(1000.0, 0.0),
        ),
        case("laser reversed", "the laser distance is", |_, _| {
            laser(-1.0, 0.0)
        }),
        case("time stands still", "sends no new readings", |_, at| {
            Fault::ClockStands {
                time_s: at.time_s[0] + 10.0,
            }
        }),
    ]
}

/// Warnings and reasons of pauses of a run, and number of measured poses.
#[derive(Default)]
struct Said {
    texts: Vec<String>,
    poses: usize,
}

/// Drives a run; faults begin once the pose labelled `begin` is stored.
fn said(preset: &Preset, (seed, poses): (u64, usize), fault: Option<(i64, MakeFault)>) -> Said {
    let (mut robot, clock): (GuardedController<SimulatedRobot>, ManualClock) =
        armed(preset, |setup| {
            *setup = crate::simulated::SimulatedSetup::of_preset(preset, seed);
        });
    let mut run = run_of(preset, poses, seed);
    let mut said = Said::default();
    for _ in 0..1_000_000 {
        clock.advance(0.05);
        for event in run.tick(&mut robot, clock.now_s()) {
            match event {
                MeasuringEvent::Measured(pose) => {
                    said.poses += 1;
                    if let Some((_, fault)) = fault.filter(|(begin, _)| *begin == pose.label()) {
                        let fault = fault(preset, &pose.readings);
                        robot.inner_mut().set_faults(vec![fault]);
                    }
                    run.confirm_stored(pose.label());
                }
                MeasuringEvent::Warning(warning) => said.texts.push(warning.text),
                // The controller cannot hold the platform there.
                MeasuringEvent::Paused { reason, .. } if reason.contains("no tensions") => {
                    run.skip();
                }
                MeasuringEvent::Paused { reason, .. } | MeasuringEvent::Failed(reason) => {
                    said.texts.push(reason);
                    return said;
                }
                MeasuringEvent::Finished => return said,
                _ => {}
            }
        }
    }
    panic!("the run does not end");
}

/// Seeds of the runs, and labels of the poses after which the fault begins.
const RUNS: [(u64, i64); 2] = [(21, 0), (24, 5)];

/// Faults that are detected but not named: the warning is that the cable is slack. In 40 other runs of each fault on each
/// robot, with two pairs of cables, this happened in 1 of 2,760; none was missed.
const UNNAMED: &[(&str, &str, u64)] = &[("force half", "mini", 24)];

#[test]
fn faults_are_noticed_and_named_with_their_cable() {
    let mut unnamed = Vec::new();
    for case in encoders().into_iter().chain(forces()).chain(others()) {
        for name in ROBOTS {
            let preset = preset(name);
            let cable = preset.robot.cables[CABLE].name.as_str();
            for (seed, begin) in RUNS {
                let said = said(&preset, (seed, 12), Some((begin, case.fault)));
                let what = format!("{} of {name}, seed {seed}", case.name);
                let of_cable = !case.name.starts_with("laser") && !case.name.starts_with("time");
                let right = |text: &&String| !of_cable || text.contains(cable);
                assert!(
                    said.texts.iter().any(|text| right(&text)),
                    "{what} is missed"
                );
                let named = said
                    .texts
                    .iter()
                    .filter(right)
                    .any(|text| text.contains(case.words));
                if !named {
                    unnamed.push((case.name, name, seed));
                }
                // An operator does not read a hundred warnings.
                assert!(
                    said.texts.len() <= 30,
                    "{what}: {} warnings",
                    said.texts.len()
                );
            }
        }
    }
    assert_eq!(unnamed, UNNAMED);
}

/// At 6 of 3,276 poses of 300 mini robots without a fault, whose true geometry differs from the description as its priors
/// say, a cable was less tense than the lower limit indeed, at the border of what can be held: more than two such warnings
/// in 165 poses have a probability of 0.4 %. Of 600 suspended and planar robots none had one; nothing else was suspected.
/// Here are 15 other robots of each kind with fixed seeds.
#[test]
fn a_sound_robot_is_hardly_ever_suspected() {
    for name in ROBOTS {
        let preset = preset(name);
        let runs: Vec<Said> = (0..15)
            .map(|run| said(&preset, (100 + run, 10), None))
            .collect();
        let poses: usize = runs.iter().map(|said| said.poses).sum();
        assert!(poses > 155, "{name}: {poses}");
        let texts = runs.iter().flat_map(|said| &said.texts);
        let (tensions, suspected): (Vec<_>, Vec<_>) =
            texts.partition(|text| text.contains(OUTSIDE_LIMITS));
        assert!(tensions.len() <= 2, "{name}: {tensions:?}");
        assert_eq!(suspected, Vec::<&String>::new(), "{name}");
    }
}

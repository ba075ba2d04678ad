//! The demonstration: MINI as drawn, and a true robot with the measured geometry, deviations of all parts within tolerances and
//! a random fault.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use tautline_core::effect::{EffectSetting, find};
use tautline_core::robot::{PartTolerances, Robot, presets};
use tautline_core::simulation::{SimulationError, SimulationOptions, TrueGeometry, simulate};
use tautline_session::{LogEntry, Phase, Session, Simulator, Timestamp};

use super::tables::{bench, home_platform};

/// Possible faults, with sizes that 25 poses of MINI reveal: identifier, smallest, largest.
const FAULTS: [(&str, f64, f64); 5] = [
    ("winch_scale", 0.012, 0.025),
    ("payload_mass", 0.15, 0.3),
    ("laser_scale", 0.008, 0.01),
    ("force_gain", 0.1, 0.2),
    ("cable_creep", 0.004, 0.008),
];

/// A session of the simulated MINI, with the tables of the first two phases as the only measurements.
///
/// # Errors
/// If the robot cannot be simulated, which has not occurred with any seed tried.
pub fn demo(seed: u64, now: Timestamp) -> Result<Session, SimulationError> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut preset = mini();
    preset.robot.tolerances = Some(PartTolerances::typical());
    let fault = fault(&preset.robot, &mut rng);
    let options = SimulationOptions {
        geometry: preset
            .measured_entry_points_m
            .map_or(TrueGeometry::Drawn, TrueGeometry::EntryPoints),
        effects: vec![fault],
        workspace: Some(preset.workspace),
        tension: Some(preset.tension),
        ..SimulationOptions::new(1, seed)
    };
    let mut nominal = preset.robot;
    let truth = simulate(&nominal, &options)?.truth;
    nominal.home_platform = Some(home_platform());
    let home = truth.home.map(|home| home.pose());
    let mut session = Session::new("Demo robot", nominal.clone(), now);
    if let Some(home) = home {
        session.phases = bench(&nominal, (&truth.deviations, &home), &mut rng);
    }
    session.simulator = Some(Simulator {
        truth,
        seed,
        revealed: false,
    });
    let text = "Opened the demonstration: a simulated robot with a hidden fault.".into();
    session.record(LogEntry {
        time: now,
        phase: Phase::Session,
        text,
    });
    Ok(session)
}

fn mini() -> presets::Preset {
    presets::find("mini").expect("a preset of this name exists")
}

fn fault(robot: &Robot, rng: &mut ChaCha8Rng) -> EffectSetting {
    let (id, smallest, largest) = FAULTS[rng.random_range(0..FAULTS.len())];
    let effect = find(id).expect("the effect is in the catalogue");
    let parameter = &effect.parameters()[0];
    // Some parameters have a definite sign: cables creep longer, not shorter.
    let may_be_negative = parameter.bounds[0] < 0.0;
    let sign = if rng.random_bool(0.5) || !may_be_negative {
        1.0
    } else {
        -1.0
    };
    let size = sign * rng.random_range(smallest..largest);
    let takes_cable = matches!(
        effect.scope(),
        tautline_core::effect::Scope::Cable | tautline_core::effect::Scope::CableOrAll
    );
    let cable = rng.random_range(0..robot.cable_count());
    let targets = if takes_cable {
        vec![robot.cables[cable].name.clone()]
    } else {
        Vec::new()
    };
    EffectSetting {
        effect: id.into(),
        targets,
        parameters: [(parameter.name.to_owned(), size)].into(),
    }
}

#[cfg(test)]
mod tests {
    use tautline_core::diagnosis::{DiagnosisOptions, Verdict, diagnose};
    use tautline_core::estimation::Control;
    use tautline_core::instrument::calibrate_winch;
    use tautline_core::planning::USUAL_POSES;

    use super::*;

    #[test]
    fn the_hidden_fault_is_found_from_the_poses_of_a_plan() {
        let (mut named, count) = (0, 5);
        let mut missed = Vec::new();
        for seed in 0..count {
            let session = demo(seed, Timestamp::from_unix_seconds(0)).expect("a session");
            let truth = session.simulator.expect("a virtual robot").truth;
            let hidden = &truth.effects[0];
            let preset = mini();
            let options = SimulationOptions {
                geometry: TrueGeometry::EntryPoints(
                    truth
                        .cables
                        .iter()
                        .map(|c| c.pulley.entry_point_m)
                        .collect(),
                ),
                effects: vec![hidden.clone()],
                workspace: Some(preset.workspace),
                tension: Some(preset.tension),
                ..SimulationOptions::new(USUAL_POSES, seed)
            };
            let dataset = simulate(&session.robot, &options)
                .expect("simulated")
                .dataset;
            let found = diagnose(&dataset, &DiagnosisOptions::default(), &mut |_| {
                Control::Continue
            })
            .expect("diagnosed");
            let is_it =
                |cause: &tautline_core::diagnosis::Cause| cause.effect().id() == hidden.effect;
            let first = found.findings.first();
            let right = first
                .is_some_and(|f| f.cause().is_some_and(is_it) && f.verdict() == Verdict::Named);
            let among = first.is_some_and(|f| f.causes().any(is_it));
            named += usize::from(right);
            if !among {
                missed.push((seed, hidden.clone(), found.findings, found.possible));
            }
        }
        assert!(missed.is_empty(), "every fault is found: {missed:#?}");
        assert!(named >= 4, "{named} of {count} are named alone");
    }

    #[test]
    fn the_bench_shows_good_winches() {
        let session = demo(3, Timestamp::from_unix_seconds(0)).expect("a session");
        assert_eq!(session.phases.home.len() % 6, 0);
        assert!(!session.phases.home.is_empty() && !session.phases.elongation.is_empty());
        for cable in 0..8 {
            let pairs = session
                .phases
                .winch
                .iter()
                .filter(|pair| pair.cable == cable);
            let pairs: Vec<_> = pairs
                .map(|pair| tautline_core::instrument::WinchPair {
                    revolutions: pair.revolutions,
                    length_m: pair.length_m,
                    tension_n: pair.tension_n,
                })
                .collect();
            let fit = calibrate_winch(&pairs).expect("a fit");
            assert!(fit.passed, "largest residual {} m", fit.largest_residual_m);
        }
    }
}

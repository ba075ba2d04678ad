//! Every way to an identification gives the same one: the commands on a dataset and on a session, the report, and the
//! call that the window makes.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use tautline_core::effect::{BoundEffect, CATALOGUE, EffectSetting, Scope};
use tautline_core::estimation::Control;
use tautline_core::measurement::{Dataset, Grid};
use tautline_core::robot::presets;
use tautline_core::simulation::{SimulationOptions, TrueGeometry, simulate};
use tautline_session::{PhaseData, Session, Simulator, Timestamp, write_dataset, write_session};
use tautline_workflow::identification::{IdentificationRequest, identify, identify_session};

use crate::commands::program::{Folder, number, tautline};

/// Combinations that are drawn.
const CASES: u64 = 40;
/// Largest relative difference of two values of chi-square.
const AGREEMENT: f64 = 1e-9;

/// A dataset and an effect that is to be freed.
struct Case {
    dataset: Dataset,
    truth: tautline_core::robot::Robot,
    effect: EffectSetting,
    /// The effect as the command line names it.
    argument: String,
    /// Description of the drawn case, for messages.
    name: String,
}

/// Draws robot, number of poses, effect and the columns that are present.
fn draw(seed: u64) -> Case {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let name = presets::NAMES[rng.random_range(0..presets::NAMES.len())];
    let preset = presets::find(name).expect("a preset");
    let (effect, argument) = effect(&preset.robot, &mut rng);
    let options = SimulationOptions {
        geometry: TrueGeometry::Drawn,
        effects: vec![effect.clone()],
        workspace: Some(preset.workspace),
        tension: Some(preset.tension),
        ..SimulationOptions::new(rng.random_range(12..26), seed)
    };
    let run = simulate(&preset.robot, &options).expect("measurements");
    let mut dataset = run.dataset;
    let data = &mut dataset.measurements;
    let mut left_out = Vec::new();
    let mut leaves_out = |column: &'static str| {
        let is_left_out = rng.random_bool(0.4);
        left_out.extend(is_left_out.then_some(column));
        is_left_out
    };
    if leaves_out("commanded") {
        data.commanded.clear();
    }
    if leaves_out("force") {
        data.force_n = Grid::default();
    }
    if leaves_out("laser") {
        data.laser_m.clear();
    }
    if leaves_out("time") {
        data.time_s.clear();
    }
    if leaves_out("inclination") {
        data.inclination_rad.clear();
    }
    if leaves_out("swivel") {
        data.swivel_rad = Grid::default();
    }
    Case {
        name: format!("{seed}: {name}, {argument}, without {left_out:?}"),
        dataset,
        truth: run.truth,
        effect,
        argument,
    }
}

/// An effect that can be estimated, on one cable where it is one of cables.
fn effect(robot: &tautline_core::robot::Robot, rng: &mut ChaCha8Rng) -> (EffectSetting, String) {
    let estimable: Vec<_> = CATALOGUE
        .iter()
        .filter(|effect| effect.is_estimable() && effect.scope() != Scope::Pair)
        .collect();
    let effect = estimable[rng.random_range(0..estimable.len())];
    let mut argument = effect.id().to_owned();
    let mut targets = Vec::new();
    if matches!(effect.scope(), Scope::Cable | Scope::CableOrAll) {
        let cable = &robot.cables[rng.random_range(0..robot.cable_count())];
        targets.push(cable.name.clone());
        argument = format!("{argument}:{}", cable.name);
    }
    let given = effect.parameters().iter().filter(|p| p.discrete);
    let parameters = given.map(|p| (p.name.to_owned(), 5.0)).collect();
    let setting = EffectSetting {
        effect: effect.id().to_owned(),
        targets,
        parameters,
    };
    for name in setting.parameters.keys() {
        argument = format!("{argument}:{name}=5");
    }
    (setting, argument)
}

#[test]
fn all_ways_to_an_identification_agree() {
    let mut identified = 0;
    for seed in 0..CASES {
        let case = draw(seed);
        let folder = Folder::new();
        let data = folder.join("data");
        write_dataset(data.as_ref(), &case.dataset, &PhaseData::default()).expect("written");
        let now = Timestamp::from_unix_seconds(0);
        let mut session = Session::new("Trial", case.dataset.robot.clone(), now);
        session.measurements = case.dataset.measurements.clone();
        session.settings.identification.effects = vec![case.effect.clone()];
        session.simulator = Some(Simulator {
            truth: case.truth.clone(),
            seed,
            revealed: false,
        });
        let file = folder.join("session.json");
        write_session(file.as_ref(), &session).expect("written");

        let own = tautline(&["identify", &data, "--effect", &case.argument, "--json", "-"]);
        let adjusted = tautline(&[
            "adjust",
            &file,
            "--controller",
            "sim",
            "--dry-run",
            "--json",
            "-",
        ]);
        let request = IdentificationRequest::of_session(&session).expect("a request");
        let keep = &mut |_: &_| Control::Continue;
        let Ok(window) = identify(&request, keep) else {
            assert_eq!(
                (own.code, adjusted.code),
                (Some(2), Some(2)),
                "{}",
                case.name
            );
            continue;
        };
        let chi2 = window.solution.chi2;
        let report = identify_session(&session, keep).expect("as the window's");
        let code = if window.solution.converged() { 0 } else { 3 };
        assert_eq!(own.code, Some(code), "{}: {}", case.name, own.stderr);
        assert_eq!(adjusted.code, Some(0), "{}: {}", case.name, adjusted.stderr);
        for (way, other) in [
            ("identify", number(&own.json(), "/chi2")),
            ("adjust", number(&adjusted.json(), "/chi2")),
            ("report", report.solution.chi2),
        ] {
            let difference = (other - chi2).abs();
            assert!(
                difference <= AGREEMENT * chi2,
                "{}: {way} {other}, window {chi2}",
                case.name
            );
        }
        identified += 1;
    }
    assert!(identified > CASES / 2, "{identified} of {CASES}");
}

/// An identification holds where its effects are taken at its own poses: taken there once more, nothing changes.
#[test]
fn effects_are_taken_at_the_poses_of_the_solution() {
    for (effect, with_commands) in [
        ("pulley_friction", true),
        ("pulley_friction", false),
        ("frame_compliance", true),
        ("frame_compliance", false),
    ] {
        let preset = presets::find("hall").expect("a preset");
        let setting = EffectSetting {
            effect: effect.to_owned(),
            targets: Vec::new(),
            parameters: Default::default(),
        };
        let bound = BoundEffect::to_estimate(&setting, &preset.robot).expect("an effect");
        let options = SimulationOptions {
            effects: vec![bound.setting(&preset.robot)],
            workspace: Some(preset.workspace),
            tension: Some(preset.tension),
            ..SimulationOptions::new(30, 7)
        };
        let mut dataset = simulate(&preset.robot, &options)
            .expect("measurements")
            .dataset;
        if !with_commands {
            dataset.measurements.commanded.clear();
        }
        let method = tautline_core::estimation::Method::Joint;
        let request = IdentificationRequest::new(dataset, method, &[setting]).expect("a request");
        let keep = &mut |_: &_| Control::Continue;
        let found = identify(&request, keep).expect("identified");
        let problem = found.problem().expect("its problem");
        let options = tautline_core::estimation::Options::default();
        let again = tautline_core::estimation::solve(&problem, &options, keep).expect("solved");
        let chi2 = found.solution.chi2;
        assert!(
            (again.chi2 - chi2).abs() <= AGREEMENT * chi2,
            "{effect}, commanded poses {with_commands}: {chi2}, then {}",
            again.chi2
        );
    }
}

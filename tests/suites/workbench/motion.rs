//! Display while the robot moves, and warnings that are kept.

use egui_kittest::kittest::Queryable;
use tautline_core::effect::EffectSetting;
use tautline_core::robot::presets;
use tautline_session::{
    PlannedPose, Session, Simulator, Stage, Timestamp, read_session, write_session,
};
use tautline_validation::support::harness::words;
use tautline_workbench::model::command::RobotCommand;
use tautline_workbench::model::link::RunStep;
use tautline_workbench::model::phase::Phase;

use crate::demo::Bench;

/// MINI whose third force sensor reads too little, so that the cable seems to be slack at some poses.
fn seemingly_slack() -> Session {
    let robot = presets::find("mini").expect("a preset").robot;
    let mut truth = robot.clone();
    truth.effects = vec![EffectSetting {
        effect: "force_bias".into(),
        targets: vec!["cable-3".into()],
        parameters: [("bias".to_owned(), -12.0)].into(),
    }];
    let home = robot.home.expect("a home pose").pose();
    let mut session = Session::new("slack", robot, Timestamp::from_unix_seconds(0));
    session.plan = vec![PlannedPose::new(0, &home)];
    session.simulator = Some(Simulator {
        truth,
        seed: 1,
        revealed: false,
    });
    session
}

fn shows(bench: &Bench, text: &str) -> bool {
    bench
        .harness
        .query_all_by_label_contains(text)
        .next()
        .is_some()
}

#[test]
fn the_panel_in_motion_has_what_matters_until_the_robot_stands() {
    let mut bench = Bench::of_session(&seemingly_slack());
    bench.go(Phase::Measuring);
    bench.give(RobotCommand::Speed(5.0));
    bench.give(RobotCommand::Plan(4));
    bench.settle("a plan");
    bench.connect_and_arm();
    let at_rest = [
        "Poses to measure",
        "Plan poses",
        "Import plan",
        "Controller",
        "Disconnect",
    ];
    for part in at_rest {
        assert!(shows(&bench, part), "{part}: {:?}", words(&bench.harness));
    }
    bench.press("Start measuring");
    bench.wait("the way to the third pose", |state| {
        let run = state.model.link.run.as_ref();
        let is_third = run.is_some_and(|run| run.current == Some(3));
        is_third && state.model.link.live().doing == RunStep::Moving
    });
    bench.harness.step();
    for part in [
        "2 of 4 poses measured",
        "Platform at x, y, z",
        "Allowed: 10 to ",
        "Last poses",
        "Pause",
        "Skip pose",
    ] {
        assert!(shows(&bench, part), "{part}: {:?}", words(&bench.harness));
    }
    for cable in 1..=8 {
        let bar = format!("Tension of cable-{cable}: ");
        assert!(shows(&bench, &bar), "{bar}");
    }
    for part in at_rest {
        assert!(!shows(&bench, part), "{part} needs no attention now");
    }
    bench.give(RobotCommand::Speed(60.0));
    bench.wait("the end", |state| !state.model.link.is_measuring());
    bench.harness.step();
    assert!(!shows(&bench, "Platform at x, y, z"));
    assert!(shows(&bench, "Plan poses"));
}

/// Phase 4 counts the warnings, and lists them at once if they are few.
fn is_listed(bench: &mut Bench, warning: &str) {
    bench.harness.step();
    assert!(shows(bench, "while measuring"));
    if !shows(bench, warning) {
        bench.press("Warnings while measuring");
        bench.harness.run_ok();
    }
    assert!(shows(bench, warning), "{:?}", words(&bench.harness));
}

#[test]
fn warnings_of_a_run_are_in_phase_4_also_of_the_saved_session() {
    let mut bench = Bench::of_session(&seemingly_slack());
    bench.measure(8);
    let kept: Vec<String> = bench
        .session()
        .measuring_warnings()
        .map(|one| one.text.clone())
        .collect();
    let slack = kept
        .iter()
        .find(|text| text.starts_with("cable-3: its tension is too low: "));
    let slack = slack.unwrap_or_else(|| panic!("{kept:?}")).clone();
    assert!(
        slack.contains(" N, at least ") && slack.contains("(at "),
        "{slack}"
    );
    assert!(shows(&bench, &slack), "the panel of the run");
    bench.go(Phase::Identification);
    is_listed(&mut bench, &slack);
    let path = bench.folder.path().join("slack.json");
    write_session(&path, bench.session()).expect("written");
    let read = read_session(&path).expect("read").value;
    let again: Vec<String> = read
        .measuring_warnings()
        .map(|one| one.text.clone())
        .collect();
    assert_eq!(again, kept);
    let mut bench = Bench::of_session(&read);
    bench.go(Phase::Identification);
    is_listed(&mut bench, &slack);
}

#[test]
fn a_stopped_verification_keeps_what_it_measured() {
    let mut bench = Bench::demo(3);
    bench.measure(3);
    bench.go(Phase::Adjustment);
    bench.press("Measure before");
    bench.wait("some targets", |state| {
        let measured = state.model.link.done_of();
        measured.is_some_and(|[done, of]| done >= 3 && done < of)
    });
    bench.harness.step();
    assert!(shows(&bench, "Test pose ") && shows(&bench, "Tension of cable-1: "));
    bench.press("Stop the robot");
    bench.wait("the end", |state| state.model.link.verifying.is_none());
    bench.harness.step();
    assert!(bench.session().verifications().is_empty());
    let stopped = bench.session().stopped_verifications();
    assert_eq!(stopped.len(), 1);
    let (rows, planned) = (stopped[0].rows.clone(), stopped[0].planned);
    assert_eq!(stopped[0].stage, Stage::Before);
    assert!(
        rows.len() >= 3 && rows.len() < planned,
        "{} of {planned}",
        rows.len()
    );
    let text = format!("stopped after {} of {planned} measurements", rows.len());
    assert!(shows(&bench, &text));
    let path = bench.folder.path().join("stopped.json");
    write_session(&path, bench.session()).expect("written");
    let read = read_session(&path).expect("read").value;
    assert_eq!(read.stopped_verifications()[0].rows, rows);
    // It shows what it has, and goes on where it stopped.
    assert!(shows(&bench, "mm off on average"));
    bench.press("Measure before");
    bench.wait("the rest", |state| state.model.link.verifying.is_none());
    bench.harness.step();
    let whole = &bench.session().verifications()[0].rows;
    assert_eq!(whole.len(), planned);
    assert_eq!(whole[..rows.len()], rows);
    assert!(!shows(&bench, "It continues where it stopped"));
}

//! The phase Measuring on a simulated robot.

use egui_kittest::kittest::Queryable;
use tautline_core::robot::presets;
use tautline_session::{PlannedPose, Session, Simulator, Timestamp};
use tautline_workbench::model::Selection;
use tautline_workbench::model::command::Export;
use tautline_workbench::model::command::{IdentificationCommand, RobotCommand, ViewCommand};
use tautline_workbench::model::phase::Phase;
use tautline_workbench::shell::AppState;

use crate::demo::Bench;

fn measured(state: &AppState) -> usize {
    let document = state.model.open.as_ref();
    document.map_or(0, |d| d.session().measurements.len())
}

fn paused(state: &AppState) -> bool {
    let run = state.model.link.run.as_ref();
    run.is_some_and(|run| run.paused.is_some())
}

#[test]
fn a_plan_is_measured_with_pause_skip_repeat_and_a_break() {
    let mut bench = Bench::demo(3);
    bench.go(Phase::Measuring);
    bench
        .harness
        .get_by_label_contains("No poses are planned yet");
    bench.press("Plan poses");
    bench.settle("a plan");
    assert_eq!(bench.session().plan.len(), 26, "home and 25 poses");
    bench
        .harness
        .get_by_label_contains("Expected standard deviation of the pulleys");
    bench
        .harness
        .get_by_label_contains("kinds of fault would be seen");
    bench.press("Show faults");
    bench
        .harness
        .get_by_label_contains("Laser scale. Laser scale (");
    bench.press("Hide faults");
    bench.connect_and_arm();
    bench.press("Start measuring");
    bench.wait("three poses", |state| measured(state) >= 3);
    bench.press("Pause");
    bench.wait("a pause", paused);
    let before = bench.session().measurements.len();
    bench
        .harness
        .get_by_label_contains("Waiting: paused by the operator");
    bench.press("Skip pose");
    bench.wait("another pose", |state| measured(state) > before);
    bench.press("Repeat last pose");
    bench.wait("a repeated pose", |state| {
        let document = state.model.open.as_ref().expect("a session");
        !document.session().excluded().is_empty()
    });
    bench.press("Stop the robot");
    bench.wait("the end", |state| !state.model.link.is_measuring());
    let ended = bench.session().measurements.len();
    bench
        .harness
        .get_by_label_contains("Measured poses are kept");
    assert!(ended < 26, "{ended} poses");
    bench.press("Continue measuring");
    bench.wait("all poses", |state| !state.model.link.is_measuring());
    // Home, 25 poses and the one that was repeated.
    assert_eq!(bench.session().measurements.len(), 27);
    assert_eq!(bench.session().excluded().len(), 1);
    bench
        .harness
        .get_by_label_contains("All planned poses are measured");
    bench.give(IdentificationCommand::Identify);
    bench.settle("an identification");
    let document = bench.state().model.open.as_ref().expect("a session");
    assert!(document.fit_is_current());
    bench.press("Next: Go to identification");
    assert!(
        bench
            .harness
            .query_by_label("Next: Go to identification")
            .is_none()
    );
    let log = bench.session().log().iter();
    let told: Vec<&str> = log.map(|entry| entry.text.as_str()).collect();
    for text in [
        "Planned 25 poses.",
        "Measuring of 25 poses and the home pose started.",
    ] {
        assert!(told.contains(&text), "{told:?}");
    }
}

#[test]
fn plan_edits_and_exclusions_are_undone_and_measurements_are_not() {
    let mut bench = Bench::demo(3);
    assert_eq!(bench.measure(6), 7);
    let select = |bench: &mut Bench, label: i64| {
        bench.give(ViewCommand::Select(Selection::pose(label)));
        bench.harness.step();
    };
    select(&mut bench, 2);
    bench.press("Exclude pose");
    assert!(bench.session().excluded().contains(&2));
    bench.give(tautline_workbench::model::command::Command::Undo);
    assert!(bench.session().excluded().is_empty());
    assert_eq!(bench.session().measurements.len(), 7);
    bench.press("Add current pose");
    assert_eq!(bench.session().plan.len(), 8);
    select(&mut bench, 7);
    bench.press("Remove from plan");
    assert_eq!(bench.session().plan.len(), 7);
    bench.give(tautline_workbench::model::command::Command::Undo);
    assert_eq!(bench.session().plan.len(), 8);
    let path = bench.folder.path().join("plan.csv");
    bench.give(RobotCommand::Export(Export::Plan, path.clone()));
    bench.settle("a file");
    let text = std::fs::read_to_string(path).expect("written");
    assert_eq!(text.lines().count(), 9, "{text}");
    // Planning again completes what is measured.
    bench.give(RobotCommand::Plan(2));
    bench.settle("a plan");
    let labels: Vec<i64> = bench.session().plan.iter().map(|p| p.label).collect();
    assert_eq!(labels, [0, 1, 2, 3, 4, 5, 6, 7, 8]);
}

/// MINI whose beam hits nothing; with `mounted` its description has a laser nevertheless.
fn without_beam(mounted: bool) -> Session {
    let mut robot = presets::find("mini").expect("a preset").robot;
    let mut truth = robot.clone();
    truth.laser = None;
    if !mounted {
        robot.laser = None;
    }
    let home = robot.home.expect("a home pose").pose();
    let mut session = Session::new("test", robot, Timestamp::from_unix_seconds(0));
    session.plan = vec![PlannedPose::new(0, &home)];
    session.simulator = Some(Simulator {
        truth,
        seed: 1,
        revealed: false,
    });
    session
}

#[test]
fn a_laser_without_a_reading_is_reported_with_advice() {
    let mut bench = Bench::of_session(&without_beam(true));
    bench.go(Phase::Measuring);
    bench.connect_and_arm();
    bench.press("Start measuring");
    bench.wait("a pause", paused);
    bench.harness.get_by_label_contains("Clear the beam path");
    assert_eq!(bench.session().measurements.len(), 0);
    bench.press("Stop the robot");
    bench.wait("the end", |state| !state.model.link.is_measuring());

    let mut bench = Bench::of_session(&without_beam(false));
    bench.go(Phase::Measuring);
    bench
        .harness
        .get_by_label_contains("This robot has no laser");
}

#[test]
fn closing_a_session_disconnects_its_robot() {
    let mut bench = Bench::demo(3);
    bench.go(Phase::Measuring);
    bench.connect_and_arm();
    let state = &mut bench.harness.state_mut().state;
    state.model.open = None;
    bench.wait("the end of the connection", |state| {
        !state.model.link.is_connected()
    });
    assert!(bench.state().model.link.connected.is_none());
}

#[test]
fn the_forecast_of_a_stored_plan_is_computed_on_demand() {
    let mut bench = Bench::demo(3);
    bench.go(Phase::Measuring);
    bench.give(RobotCommand::Plan(8));
    bench.settle("a plan");
    let expected = bench
        .state()
        .model
        .outlook
        .as_ref()
        .map(|o| o.result.clone());
    let expected = expected.expect("it was planned").expect("it is known");
    let session = bench.session().clone();
    drop(bench);
    let mut bench = Bench::of_session(&session);
    bench.go(Phase::Measuring);
    bench.settle("what to expect");
    bench.harness.step();
    bench
        .harness
        .get_by_label_contains("Expected standard deviation of the pulleys");
    let again = bench
        .state()
        .model
        .outlook
        .as_ref()
        .map(|o| o.result.clone());
    let again = again.expect("it was asked").expect("it is known");
    assert_eq!(again.poses, expected.poses);
    let sd_m = again.expected.mean_m.expect("determined");
    let planned_m = expected.expected.mean_m.expect("determined");
    // A file has the poses to so many digits.
    assert!((sd_m / planned_m - 1.0).abs() < 1e-6, "{sd_m} {planned_m}");
}

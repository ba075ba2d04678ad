//! The window with a controller that misbehaves: it has the same messages as the commands, and the same precautions.

use std::time::Instant;

use egui_kittest::kittest::Queryable;
use tautline_core::robot::presets;
use tautline_link::adjusting::{Adjustment as Attempt, ControllerValues};
use tautline_session::{AdsPlace, ControllerKind, Outcome, PlannedPose, Session, Timestamp};
use tautline_validation::support::ads::symbols::global;
use tautline_validation::support::ads::unruly::{Action, RequestKind, Unruly};
use tautline_validation::support::ads::{Host, Plant};
use tautline_workbench::model::command::{Answer, FileCommand, RobotCommand};
use tautline_workbench::model::link::LinkRequest;
use tautline_workbench::model::link::scope::Scope;
use tautline_workbench::model::phase::Phase;
use tautline_workbench::shell::AppState;
use tautline_workflow::adjusting::{self, Purpose};
use tautline_workflow::wording::sentence;

use crate::demo::Bench;

/// MINI at the plant, with the home pose and two others planned.
fn connected(plant: &Plant<Unruly>) -> Bench {
    let robot = presets::find("mini").expect("a preset").robot;
    let mut session = Session::new("test", robot, Timestamp::from_unix_seconds(0));
    let home = session.robot.home.expect("a home pose").pose();
    session.plan = [(0, 0.0), (1, 0.04), (2, -0.04)]
        .map(|(label, x)| {
            let mut pose = home;
            pose.position.x += x;
            PlannedPose::new(label, &pose)
        })
        .to_vec();
    let address = plant.server.address();
    session.connection.controller = ControllerKind::Ads;
    session.connection.place = Some(AdsPlace {
        host: address.host,
        port: address.port,
        net_id: address.net_id,
        ams_port: address.ams_port,
        timeout_s: 5.0,
    });
    let mut bench = Bench::of_session(&session);
    bench.give(RobotCommand::Connect);
    bench.wait("a connection", |state| state.model.link.is_connected());
    arm(&mut bench);
    bench
}

fn arm(bench: &mut Bench) {
    bench.give(RobotCommand::Arm);
    bench.wait("arming", |state| state.model.link.is_armed());
}

fn told(state: &AppState, part: &str) -> bool {
    let mut all = state.model.messages.all().iter();
    all.any(|message| message.text.contains(part))
}

fn measured(state: &AppState) -> usize {
    let open = state.model.open.as_ref();
    open.map_or(0, |open| open.session().measurements.len())
}

#[test]
fn a_half_written_adjustment_is_settled_when_the_operator_arms_again() {
    let plant = Plant::unruly();
    let mut bench = connected(&plant);
    let held = bench.state().model.link.parameters.clone();
    let points = held.iter().filter(|p| p.name.contains("entry_point"));
    let new: Vec<(String, f64)> = points
        .take(3)
        .map(|p| (p.name.clone(), p.value + 1e-3))
        .collect();
    plant
        .server
        .fault(RequestKind::Write, 1, Action::DownAfterValues(1));
    bench.give(RobotCommand::WriteValues(new.clone(), Purpose::Adjust));
    // The record is there before the first value.
    let begun = bench
        .session()
        .adjustments()
        .last()
        .expect("a record")
        .clone();
    assert_eq!(begun.outcome, Outcome::Begun);
    bench.wait("an outcome", |state| !state.model.link.writing);
    assert!(told(
        bench.state(),
        "Warning: the values in the controller are not known."
    ));
    let open = bench
        .session()
        .adjustments()
        .last()
        .expect("a record")
        .clone();
    assert!(matches!(open.outcome, Outcome::Unsettled(_)), "{open:?}");
    let unsettled = adjusting::unsettled(bench.session()).expect("a sentence");
    plant.server.up();
    bench.give(LinkRequest::TryNow);
    bench.wait("the connection", |state| state.model.link.is_connected());
    let mixed = ControllerValues::Mixed(vec![new[0].0.clone()]);
    let found = adjusting::found(&open, &mixed);
    bench.wait("what was found", |state| told(state, &found));
    // Nothing moves and nothing is written meanwhile.
    let values = plant.server.values();
    for command in [
        RobotCommand::Start,
        RobotCommand::Verify(tautline_session::Stage::Before),
        RobotCommand::Repeat(0),
    ] {
        bench.give(command);
        assert!(!bench.state().model.link.is_busy());
        let last = bench
            .state()
            .model
            .messages
            .last()
            .expect("a message")
            .text
            .clone();
        assert!(last.starts_with(&sentence(&unsettled)), "{last}");
    }
    assert_eq!(plant.server.values(), values);
    arm(&mut bench);
    let settled = adjusting::settled(
        &open,
        &mixed,
        &Attempt {
            holds: ControllerValues::Old,
            old: Vec::new(),
            problem: None,
            advice: "The controller holds its old values: find the cause, then write again.".into(),
        },
        None,
    );
    bench.wait("the old values", |state| told(state, &settled.1));
    let record = bench
        .session()
        .adjustments()
        .last()
        .expect("a record")
        .clone();
    assert_eq!((record.outcome, record.changes), (settled.0, begun.changes));
    let point = plant.server.numbers("GVL_Tautline.entry_point");
    assert_eq!(
        point[0],
        held.iter()
            .find(|p| p.name == new[0].0)
            .expect("it is there")
            .value
    );
    assert_eq!(
        bench.session().log().last().expect("an entry").text,
        settled.1
    );
}

#[test]
fn an_overload_waits_for_the_operator_each_time() {
    let plant = Plant::unruly();
    let mut bench = connected(&plant);
    bench.give(RobotCommand::Start);
    bench.wait("home", |state| measured(state) == 1);
    plant.show_force(Some((2, 500.0)));
    let paused = |state: &AppState| {
        let run = state.model.link.run.as_ref();
        run.and_then(|run| run.paused.clone())
    };
    let overload = "cable-3 pulls with";
    bench.wait("a stop", |state| {
        paused(state).is_some_and(|why| why.contains(overload))
    });
    assert!(measured(bench.state()) < 3);
    // The operator continues; a larger overload stops the run again.
    bench.give(LinkRequest::Resume);
    bench.wait("going on", |state| paused(state).is_none());
    plant.show_force(Some((2, 600.0)));
    bench.wait("another stop", |state| {
        paused(state).is_some_and(|why| why.contains(overload))
    });
    plant.show_force(None);
    bench.give(LinkRequest::Resume);
    bench.wait("the end", |state| !state.model.link.is_measuring());
    assert_eq!(measured(bench.state()), 3);
}

#[test]
fn other_clients_and_restarts_end_the_run_with_the_sentence_of_the_commands() {
    let plant = Plant::unruly();
    let mut bench = connected(&plant);
    bench.give(RobotCommand::Start);
    bench.wait("home", |state| measured(state) == 1);
    plant.command_as_another(3.0);
    bench.wait("the end", |state| !state.model.link.is_measuring());
    assert!(told(bench.state(), "another client commands it"));
    let kept = measured(bench.state());
    assert!(kept < 3);
    plant.restart(0.05);
    bench.wait("the loss", |state| told(state, "reconnects by itself"));
    bench.wait("the connection", |state| state.model.link.is_connected());
    arm(&mut bench);
    bench.give(RobotCommand::Start);
    bench.wait("the end", |state| !state.model.link.is_measuring());
    assert!(
        told(bench.state(), "the controller was restarted"),
        "{:?}",
        bench.state().model.messages.all()
    );
    assert_eq!(measured(bench.state()), kept);
    // The rest is measured in a session of its own.
    let plan = bench.session().plan.clone();
    bench.go(Phase::Measuring);
    // The present readings are saved before another series begins.
    let kept = bench.folder.path().join("kept.json");
    bench.give(FileCommand::SaveAs(kept));
    bench.settle("a file");
    bench.press("Begin a new series");
    // The controller is armed.
    bench.give(FileCommand::Answer(Answer::Discard));
    bench.wait("the series", |state| measured(state) == 0);
    let series = bench.session();
    assert_eq!((series.measurements.len(), &series.plan), (0, &plan));
    assert_eq!(series.name, "test, another series");
}

#[test]
fn values_written_by_another_client_mark_the_poses_and_the_window_says_so() {
    let plant = Plant::unruly();
    let mut bench = connected(&plant);
    bench.give(RobotCommand::Start);
    bench.wait("a pose", |state| measured(state) > 0);
    let mut drums = plant.server.numbers(&global("drum_diameter"));
    drums[1] += 1e-3;
    plant
        .server
        .write_as_another(&global("drum_diameter"), &drums);
    bench.wait("the end", |state| !state.model.link.is_measuring());
    let said =
        "While poses 1, 2 and home were measured, somebody else changed values of the controller";
    bench.wait("a message", |state| told(state, said));
    let session = bench.session();
    assert_eq!(session.foreign_writes().count(), 1);
    assert!(session.log().iter().any(|step| step.text.contains(said)));
    bench.go(Phase::Identification);
    assert!(bench.harness.get_all_by_label_contains(said).count() > 0);
}

#[test]
fn readings_that_are_sent_reach_the_scope() {
    let plant = Plant::unruly();
    plant.server.run_clock(&global("time"), Instant::now());
    let mut bench = connected(&plant);
    let readings = |state: &AppState| state.model.link.scope(Scope::readings).unwrap_or(0);
    let asked = plant.server.count(RequestKind::Read);
    let shown = readings(bench.state());
    bench.wait("readings", |state| readings(state) >= shown + 100);
    // Far more are shown than were asked for.
    let asked = plant.server.count(RequestKind::Read) - asked;
    assert!(asked < 50, "{asked} requests");
    bench.give(LinkRequest::Disconnect);
    bench.give(FileCommand::Answer(Answer::Discard));
    bench.wait("the end", |state| !state.model.link.is_connected());
    assert_eq!(plant.server.subscriptions(), 0);
}

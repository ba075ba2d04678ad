//! Measuring until goals are reached, in the window.

use std::path::Path;

use egui::{Key, Role};
use egui_kittest::kittest::Queryable;
use tautline_core::measurement::Measurements;
use tautline_core::robot::presets;
use tautline_core::sequential::{Goal, NextStep};
use tautline_core::simulation::{SimulationOptions, true_robot};
use tautline_session::{
    AdsPlace, ControllerKind, OpcUaPlace, PlannedPose, Session, Simulator, Timestamp,
    UntilSettings, find_unsaved_sessions,
};
use tautline_validation::support::ads::symbols::Style;
use tautline_validation::support::ads::unruly::Unruly;
use tautline_validation::support::ads::{Host, Plant, Protocol};
use tautline_validation::support::decisions::check_decisions;
use tautline_validation::support::harness::words;
use tautline_workbench::model::command::{Command, RobotCommand};
use tautline_workbench::model::link::LinkRequest;
use tautline_workbench::model::phase::Phase;
use tautline_workbench::shell::AppState;
use tautline_workflow::sequential::{DecidedPose, UntilRequest};

use crate::demo::Bench;
use crate::support::type_into;

/// An accuracy (m) that MINI reaches after some twenty poses, so that a run is still going after a dozen.
const BEYOND_M: f64 = 1.3e-3;

/// MINI, whose true robot is drawn.
fn mini() -> Session {
    let robot = presets::find("mini").expect("a preset").robot;
    let truth = true_robot(&robot, &SimulationOptions::new(0, 1));
    let mut session = Session::new("test", robot, Timestamp::from_unix_seconds(0));
    session.simulator = Some(Simulator {
        truth,
        seed: 1,
        revealed: false,
    });
    session
}

fn until(goal: Goal, at_most: usize) -> UntilSettings {
    UntilSettings {
        enabled: true,
        goals: vec![goal],
        at_most,
        only_planned: false,
    }
}

/// Poses in the session, home included.
fn measured(state: &AppState) -> usize {
    let open = state.model.open.as_ref();
    open.map_or(0, |open| open.session().measurements.len())
}

fn has_ended(state: &AppState) -> bool {
    !state.model.link.is_measuring()
}

fn shows(bench: &Bench, part: &str) -> bool {
    let labels = bench.harness.query_all_by_label_contains(part).count();
    labels > 0 || words(&bench.harness).iter().any(|text| text.contains(part))
}

/// Checks that every pose of the session was decided on by those before, as by the command; returns the last decision.
fn last_step(bench: &Bench) -> NextStep {
    let session = bench.session();
    check_decisions(session, &UntilRequest::of_session(session)).step
}

/// Checks that the first poses of a session are the kept ones.
fn check_kept(session: &Session, kept: &Measurements) {
    let rows: Vec<usize> = (0..kept.len()).collect();
    let first = session.measurements.select(&rows);
    assert_eq!(first.labels, kept.labels);
    assert_eq!(first.laser_m, kept.laser_m);
    assert_eq!(first.revolutions, kept.revolutions);
}

/// Chooses an amount in a field.
fn enter(bench: &mut Bench, name: &str, text: &str) {
    type_into(&mut bench.harness, Role::TextInput, name, text);
    bench.harness.key_press(Key::Enter);
    bench.harness.step();
    bench.harness.step();
}

#[test]
fn goals_are_chosen_and_the_run_ends_when_they_are_reached() {
    let mut bench = Bench::of_session(&mini());
    bench.go(Phase::Measuring);
    bench.press("Measure until certain");
    assert!(!shows(&bench, "Plan poses"), "no plan is needed");
    bench.press("The cause is found, with");
    assert!(shows(&bench, "Choose at least one goal."));
    bench.press("All pulleys are accurate to");
    enter(&mut bench, "Accuracy of the pulleys", "2.4");
    enter(&mut bench, "Largest number of poses", "40");
    enter(&mut bench, "Probability of no fault", "99");
    let refused = "Probability of no fault: found the probability \"99%\", expected 50 to 98%";
    assert!(shows(&bench, refused), "{:?}", words(&bench.harness));
    bench.harness.key_press(Key::Escape);
    let settings = until(Goal::Accuracy(2.4e-3), 40);
    assert_eq!(bench.session().settings.until, settings);
    bench.press("Next: Connect and arm the simulated robot");
    bench.wait("arming", |state| state.model.link.is_armed());
    bench.press("Next: Start measuring");
    bench.wait("home and a pose", |state| measured(state) > 1);
    assert!(shows(&bench, "The first 8 poses determine the geometry"));
    assert!(shows(&bench, "of at most 40 poses measured"));
    bench.wait("a decision", |state| {
        measured(state) > 8 && chosen(state).is_some()
    });
    assert!(shows(&bench, "Accuracy of the pulleys, goal 2.40 mm"));
    assert!(shows(&bench, " narrows the pulley of cable-"));
    bench.wait("the end", has_ended);
    bench.harness.step();
    assert!(matches!(last_step(&bench), NextStep::Reached));
    let poses = bench.session().measurements.len() - 1;
    assert!(poses > 8 && poses < 40, "{poses} poses");
    assert!(shows(
        &bench,
        &format!("All goals reached after {poses} poses.")
    ));
    let log: Vec<&str> = bench
        .session()
        .log()
        .iter()
        .map(|e| e.text.as_str())
        .collect();
    let begun = "Measuring until all pulleys are accurate to 2.40 mm, at most 40 poses.";
    assert!(log.contains(&begun), "{log:?}");
    assert!(log.contains(&"Pose 1 was chosen: it is one of the 8 poses that fix the geometry."));
    let ended = format!("Measured {poses} poses and the home pose, all goals reached.");
    assert_eq!(log.last(), Some(&ended.as_str()));
    assert!(shows(&bench, "Next: Identify the pulleys"));
    // Poses planned by the run are not edits.
    bench.give(Command::Undo);
    assert_eq!(bench.session().plan.len(), poses + 1);
}

#[test]
fn causes_that_are_possible_have_bars_and_the_limit_ends_the_run() {
    let mut session = mini();
    // A robot without a fault is known soon, how accurate it is later.
    session.settings.until = until(Goal::Accuracy(BEYOND_M), 9);
    session.settings.until.goals.push(Goal::Cause(0.98));
    let mut bench = Bench::of_session(&session);
    bench.go(Phase::Measuring);
    bench.connect_and_arm();
    bench.press("Start measuring");
    bench.wait("a decision", |state| {
        measured(state) == 9 && chosen(state).is_some()
    });
    assert!(shows(&bench, "The cause is found, goal 98 %"));
    assert!(shows(&bench, "Probability of no fault: "));
    let chosen = chosen(bench.state()).expect("a pose");
    let reason = format!("Pose {} {}.", chosen.pose, chosen.reason);
    assert!(shows(&bench, &reason), "{:?}", words(&bench.harness));
    bench.wait("the end", has_ended);
    bench.harness.step();
    assert!(matches!(last_step(&bench), NextStep::AtLimit));
    assert_eq!(bench.session().measurements.len(), 10);
    assert!(shows(
        &bench,
        "The largest number of poses reached after 9 poses."
    ));
}

/// The pose that was chosen last, while it is not measured.
fn chosen(state: &AppState) -> Option<DecidedPose> {
    let until = state.model.link.run.as_ref()?.until.as_ref()?;
    let known = until.assessment().filter(|_| !until.is_deciding());
    known.and(until.poses().last().cloned())
}

#[test]
fn a_stopped_run_keeps_every_pose_and_goes_on_with_the_same_decisions() {
    let mut session = mini();
    session.settings.until = until(Goal::Accuracy(BEYOND_M), 40);
    let mut bench = Bench::of_session(&session);
    bench.go(Phase::Measuring);
    bench.connect_and_arm();
    bench.press("Start measuring");
    // In the middle of the first poses, and while poses are decided on.
    for poses in [5, 11] {
        bench.wait("poses", |state| measured(state) >= poses);
        bench.press("Stop the robot");
        bench.wait("the end", has_ended);
        let kept = bench.session().measurements.clone();
        assert!(kept.len() >= poses);
        bench.press("Continue measuring");
        bench.wait("another pose", |state| measured(state) > kept.len());
        check_kept(bench.session(), &kept);
    }
    bench.wait("the end", has_ended);
    assert!(matches!(last_step(&bench), NextStep::Reached));
}

#[test]
fn what_a_killed_window_leaves_goes_on_with_the_same_decisions() {
    let mut session = mini();
    session.settings.until = until(Goal::Accuracy(BEYOND_M), 40);
    let mut bench = Bench::of_session(&session);
    bench.go(Phase::Measuring);
    bench.connect_and_arm();
    bench.press("Start measuring");
    bench.wait("a decision", |state| measured(state) >= 11);
    // Copy of the files on disk at this moment.
    let disk = tempfile::tempdir().expect("a folder");
    copy(&bench.state().model.folders.recovery(), disk.path());
    let left = find_unsaved_sessions(disk.path()).expect("readable");
    let recovered = left[0].recover().expect("a session").value.session;
    let kept = recovered.measurements.clone();
    assert!(kept.len() >= 11, "{}", kept.len());
    drop(bench);
    let mut bench = Bench::of_session(&recovered);
    bench.go(Phase::Measuring);
    bench.connect_and_arm();
    bench.press("Continue measuring");
    bench.wait("the end", has_ended);
    check_kept(bench.session(), &kept);
    assert!(matches!(last_step(&bench), NextStep::Reached));
}

/// Copies the content of a folder.
fn copy(from: &Path, to: &Path) {
    for entry in std::fs::read_dir(from).expect("a folder") {
        let entry = entry.expect("an entry");
        let target = to.join(entry.file_name());
        if entry.path().is_dir() {
            std::fs::create_dir(&target).expect("made");
            copy(&entry.path(), &target);
        } else {
            std::fs::copy(entry.path(), target).expect("copied");
        }
    }
}

#[test]
fn repeated_and_skipped_poses_leave_the_decisions_in_order() {
    let mut session = mini();
    session.settings.until = until(Goal::Accuracy(BEYOND_M), 12);
    let mut bench = Bench::of_session(&session);
    bench.go(Phase::Measuring);
    bench.connect_and_arm();
    bench.press("Start measuring");
    bench.wait("three poses", |state| measured(state) >= 3);
    bench.press("Pause");
    bench.wait("a pause", |state| {
        let run = state.model.link.run.as_ref();
        run.is_some_and(|run| run.paused.is_some())
    });
    bench.press("Repeat last pose");
    bench.press("Resume");
    bench.wait("a repeated pose", |state| {
        let open = state.model.open.as_ref().expect("a session");
        !open.session().excluded().is_empty()
    });
    bench.press("Skip pose");
    bench.wait("the end", has_ended);
    let session = bench.session();
    let labels = &session.measurements.labels;
    let mut once = labels.clone();
    once.sort_unstable();
    once.dedup();
    assert_eq!(once.len(), labels.len(), "{labels:?}");
    // Home, and the poses that count; the repeated one is left out.
    assert_eq!(labels.len() - session.excluded().len(), 13);
    let left_out = |entry: &str| entry.ends_with(" was left out.");
    assert!(session.log().iter().any(|entry| left_out(&entry.text)));
}

#[test]
fn only_poses_of_the_plan_are_measured_where_that_is_asked_for() {
    let mut session = mini();
    let home = session.robot.home.expect("a home pose").pose();
    let planned = |label: i64| {
        let mut pose = home;
        pose.position.x += 0.01 * label as f64;
        PlannedPose::new(label, &pose)
    };
    session.plan = (0..4).map(planned).collect();
    session.settings.until = until(Goal::Accuracy(BEYOND_M), 40);
    session.settings.until.only_planned = true;
    let mut bench = Bench::of_session(&session);
    connect(&mut bench);
    bench.give(RobotCommand::Start);
    bench.wait("the end", has_ended);
    assert_eq!(bench.session().plan, session.plan);
    assert_eq!(bench.session().measurements.len(), 4);
    let ended = bench.session().log().last().expect("an entry");
    assert!(
        ended
            .text
            .ends_with("no pose would bring the goals closer."),
        "{}",
        ended.text
    );
}

/// A session of MINI that measures ten poses over ADS.
fn over_ads(plant: &Plant<Unruly>) -> Session {
    let mut session = mini();
    session.simulator = None;
    session.settings.until = until(Goal::Accuracy(BEYOND_M), 10);
    let address = plant.server.address();
    session.connection.controller = ControllerKind::Ads;
    session.connection.place = Some(AdsPlace {
        host: address.host,
        port: address.port,
        net_id: address.net_id,
        ams_port: address.ams_port,
        timeout_s: 5.0,
    });
    session
}

fn connect(bench: &mut Bench) {
    bench.give(RobotCommand::Connect);
    bench.wait("a connection", |state| state.model.link.is_connected());
    arm(bench);
}

fn arm(bench: &mut Bench) {
    bench.give(RobotCommand::Arm);
    bench.wait("arming", |state| state.model.link.is_armed());
}

#[test]
fn a_lost_connection_keeps_every_pose_and_the_run_goes_on_with_the_same_decisions() {
    let plant = Plant::unruly();
    let mut bench = Bench::of_session(&over_ads(&plant));
    connect(&mut bench);
    bench.go(Phase::Measuring);
    bench.press("Start measuring");
    for poses in [3, 9] {
        bench.wait("poses", |state| measured(state) >= poses);
        plant.server.down();
        bench.wait("the loss", |state| state.model.link.lost().is_some());
        let kept = bench.session().measurements.clone();
        assert!(bench.state().model.link.is_measuring(), "the run waits");
        plant.server.up();
        bench.give(LinkRequest::TryNow);
        bench.wait("the connection", |state| state.model.link.is_connected());
        arm(&mut bench);
        bench.press("Resume");
        bench.wait("another pose", |state| measured(state) > kept.len());
        check_kept(bench.session(), &kept);
    }
    bench.wait("the end", has_ended);
    assert!(matches!(last_step(&bench), NextStep::AtLimit));
    assert_eq!(bench.session().measurements.len(), 11);
}

#[test]
fn a_controller_with_opcua_goes_to_the_poses_that_are_decided_on() {
    let plant = Plant::fast(Protocol::OpcUa, Style::Arrays);
    let mut session = mini();
    session.simulator = None;
    session.settings.until = until(Goal::Accuracy(BEYOND_M), 9);
    let url = plant.server.url();
    session.connection.controller = ControllerKind::OpcUa;
    session.connection.opcua = Some(OpcUaPlace {
        host: url.host,
        port: url.port,
        path: url.path,
        security: None,
        policy: None,
        user: None,
        user_certificate: None,
        timeout_s: 20.0,
    });
    let mut bench = Bench::of_session(&session);
    connect(&mut bench);
    bench.go(Phase::Measuring);
    bench.press("Start measuring");
    bench.wait("the end", has_ended);
    assert!(matches!(last_step(&bench), NextStep::AtLimit));
    assert_eq!(bench.session().measurements.len(), 10);
}

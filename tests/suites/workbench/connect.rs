//! The connection dialog, with recordings, typed laser distances, and a controller over ADS.

use egui::{Key, Modifiers, Role};
use egui_kittest::kittest::{NodeT, Queryable};
use serde_json::json;
use tautline_core::measurement::Dataset;
use tautline_core::robot::presets;
use tautline_core::simulation::{SimulationOptions, simulate};
use tautline_session::{
    ControllerKind, LaserSettings, Outcome, PhaseData, PlannedPose, Session, Timestamp,
    write_dataset,
};
use tautline_validation::support::harness::words;
use tautline_workbench::model::command::{Answer, Command, FileCommand, RobotCommand, Setup};
use tautline_workbench::model::link::LinkRequest;
use tautline_workbench::model::link::RunStep;
use tautline_workbench::model::phase::Phase;
use tautline_workbench::shell::AppState;
use tautline_workflow::adjusting::Purpose;

use crate::demo::Bench;
use crate::support;
use tautline_validation::support::ads::Plant;
use tautline_validation::support::ads::symbols::{Style, global};

/// MINI with as many poses planned as measured here beforehand, home among them.
fn planned(poses: usize) -> (Session, Dataset) {
    let preset = presets::find("mini").expect("a preset");
    let options = SimulationOptions {
        workspace: Some(preset.workspace),
        tension: Some(preset.tension),
        ..SimulationOptions::new(poses, 1)
    };
    let dataset = simulate(&preset.robot, &options)
        .expect("measurements")
        .dataset;
    let mut session = Session::new("test", preset.robot, Timestamp::from_unix_seconds(0));
    let rows = dataset.measurements.labels.iter();
    let rows = rows.zip(&dataset.measurements.commanded).take(poses);
    session.plan = rows
        .map(|(label, pose)| {
            let pose = pose.expect("a commanded pose");
            PlannedPose {
                label: *label,
                position_m: pose.position.into(),
                orientation_wxyz: pose.orientation_wxyz(),
            }
        })
        .collect();
    (session, dataset)
}

fn measured(state: &AppState) -> usize {
    let document = state.model.open.as_ref();
    document.map_or(0, |d| d.session().measurements.len())
}

fn told(state: &AppState, part: &str) -> bool {
    let mut all = state.model.messages.all().iter();
    all.any(|message| message.text.contains(part))
}

/// Whether any text on the screen contains this part.
fn shows(bench: &Bench, part: &str) -> bool {
    words(&bench.harness).iter().any(|text| text.contains(part))
}

/// Lets a window that was opened take its size.
fn opened(bench: &mut Bench) {
    for _ in 0..3 {
        bench.harness.step();
    }
}

fn type_into(bench: &mut Bench, name: &str, text: &str) {
    support::type_into(&mut bench.harness, Role::TextInput, name, text);
}

fn is_enabled(bench: &Bench, name: &str) -> bool {
    let node = bench.harness.get_by_label(name);
    !node.accesskit_node().is_disabled()
}

#[test]
fn invalid_entries_are_explained_beside_their_fields_and_settings_can_be_undone() {
    let (session, _) = planned(3);
    let mut bench = Bench::of_session(&session);
    bench.go(Phase::Measuring);
    bench.settle("what to expect of the plan");
    bench.press("Choose controller…");
    opened(&mut bench);
    assert!(
        is_enabled(&bench, "Connect"),
        "a simulated robot needs nothing"
    );
    bench.press("Beckhoff controller (ADS)");
    assert!(!is_enabled(&bench, "Connect"));
    // An empty field is not a mistake: only the foot of the window states what is missing.
    assert!(shows(
        &bench,
        "Not ready to connect: Controller: found nothing"
    ));
    assert!(
        !shows(&bench, "Found nothing"),
        "{:?}",
        words(&bench.harness)
    );
    type_into(&mut bench, "Host", "plc");
    type_into(&mut bench, "AMS Net ID", "1.2.3");
    assert!(shows(&bench, "expected six numbers from 0 to 255"));
    type_into(&mut bench, "AMS Net ID", "5.23.9.1.1.1");
    type_into(&mut bench, "Port", "0");
    assert!(shows(&bench, "expected a number from 1 to 65535"));
    type_into(&mut bench, "Port", "48898");
    assert!(is_enabled(&bench, "Connect"));
    bench.press("Laser source");
    bench.press("From a device in the network");
    assert!(shows(&bench, "expected the name or address of the laser"));
    bench.press("Typed by the operator at every pose");
    bench.press("Symbols");
    bench.press("Custom names");
    type_into(&mut bench, "Scale: Motor revolutions", "many");
    assert!(shows(&bench, "expected a number such as 12.5"));
    type_into(&mut bench, "Scale: Motor revolutions", "-0.5");
    bench.press("Save settings");
    assert!(
        bench
            .harness
            .query_by_label("Connect to a controller")
            .is_none()
    );
    let kept = bench.session().connection.clone();
    assert_eq!(kept.controller, ControllerKind::Ads);
    assert_eq!(
        kept.place.as_ref().map(|place| place.host.as_str()),
        Some("plc")
    );
    let scale = kept.ads.as_ref().map(|ads| ads.readings.revolutions.scale);
    assert_eq!(scale, Some(-0.5));
    assert_eq!(bench.session().laser_source, LaserSettings::Manual);
    assert_eq!(
        bench.state().model.preferences.last_connection.place,
        kept.place
    );
    bench.give(Command::Undo);
    assert!(bench.session().connection.is_empty());
    bench.give(Command::Redo);
    assert_eq!(bench.session().connection, kept);
}

#[test]
fn a_replayed_recording_is_never_shown_as_a_robot() {
    let (session, dataset) = planned(3);
    let mut bench = Bench::of_session(&session);
    let folder = bench.folder.path().join("recorded");
    write_dataset(&folder, &dataset, &PhaseData::default()).expect("written");
    bench.go(Phase::Measuring);
    bench.settle("what to expect of the plan");
    bench.give(RobotCommand::Setup(Setup::Open));
    opened(&mut bench);
    bench.press("Recording");
    type_into(&mut bench, "Folder", "no/such/folder");
    type_into(&mut bench, "Speed", "100");
    bench.press("Connect");
    bench.wait("a refusal", |state| !state.model.link.connecting);
    bench.harness.step();
    assert!(shows(&bench, "not found"), "{:?}", words(&bench.harness));
    type_into(&mut bench, "Folder", &folder.display().to_string());
    bench.press("Connect");
    bench.wait("a connection", |state| state.model.link.is_connected());
    assert!(
        bench.state().panels.connect.is_none(),
        "the window has closed"
    );
    assert!(shows(&bench, "recording, no robot"));
    assert!(shows(&bench, "This is a recording: nothing moves"));
    bench.press("Arm");
    bench.wait("arming", |state| state.model.link.is_armed());
    bench.press("Start measuring");
    bench.wait("three poses", |state| measured(state) == 3);
    bench.wait("the end", |state| !state.model.link.is_measuring());
    let measurements = &bench.session().measurements;
    for (row, label) in measurements.labels.iter().enumerate() {
        let recorded = dataset.measurements.labels.iter().position(|l| l == label);
        let recorded = recorded.expect("the same label");
        let off_m = measurements.laser_m[row] - dataset.measurements.laser_m[recorded];
        assert!(off_m.abs() < 1e-9, "{off_m}");
    }
    let values = vec![("home.x_m".into(), 0.0)];
    bench.give(RobotCommand::WriteValues(values, Purpose::Adjust));
    bench.wait("a refusal", |state| {
        told(state, "in which nothing can be changed")
    });
}

#[test]
fn a_typed_laser_distance_is_requested_at_every_pose() {
    let (mut session, _) = planned(3);
    session.laser_source = LaserSettings::Manual;
    let mut bench = Bench::of_session(&session);
    bench.go(Phase::Measuring);
    bench.settle("what to expect of the plan");
    bench.connect_and_arm();
    bench.press("Start measuring");
    let asked = |state: &AppState| match state.model.link.live().doing {
        RunStep::Asking { label, expected_m } => Some((label, expected_m)),
        _ => None,
    };
    let mut typed = Vec::new();
    for pose in 0..3 {
        bench.wait("a question", |state| {
            measured(state) == pose && asked(state).is_some()
        });
        let (label, expected_m) = asked(bench.state()).expect("a question");
        let expected_mm = expected_m.expect("it can be said") * 1e3;
        let name = match label {
            0 => "Laser distance at home".to_owned(),
            label => format!("Laser distance at pose {label}"),
        };
        let field = |bench: &Bench, is: &dyn Fn(&egui_kittest::Node<'_>) -> bool| {
            let mut all = bench.harness.query_all_by_label(&name);
            all.any(|node| node.accesskit_node().role() == Role::TextInput && is(&node))
        };
        assert!(
            field(&bench, &|node| node.is_focused()),
            "the keys go there"
        );
        let type_text = |bench: &mut Bench, text: &str| {
            bench
                .harness
                .key_press_modifiers(Modifiers::COMMAND, Key::A);
            bench.harness.step();
            bench.harness.event(egui::Event::Text(text.to_owned()));
            bench.harness.step();
            bench.harness.step();
        };
        type_text(&mut bench, "12,x");
        assert!(shows(&bench, "expected a number such as 12.5"));
        type_text(&mut bench, &format!("{:.2}", 10.0 * expected_mm));
        let far = format!("Expected about {expected_mm:.0} mm. Check the reading");
        assert!(shows(&bench, &far), "{:?}", words(&bench.harness));
        let text = format!("{expected_mm:.2}");
        type_text(&mut bench, &text);
        assert!(shows(&bench, "As expected."));
        bench.harness.key_press(Key::Enter);
        typed.push(text.parse::<f64>().expect("a number") * 1e-3);
        bench.wait("the pose", |state| measured(state) > pose);
    }
    // The robot is simulated from the description, which a report has to state.
    assert!(bench.session().is_simulated());
    let laser_m = &bench.session().measurements.laser_m;
    let same = laser_m
        .iter()
        .zip(&typed)
        .all(|(a, b)| (a - b).abs() < 1e-9);
    assert!(same, "{laser_m:?} {typed:?}");
}

/// Fills the window that connects with the address of a plant.
fn fill(bench: &mut Bench, plant: &Plant) {
    let address = plant.server.address();
    bench.give(RobotCommand::Setup(Setup::Open));
    opened(bench);
    bench.press("Beckhoff controller (ADS)");
    type_into(bench, "Host", &address.host);
    type_into(bench, "Port", &address.port.to_string());
    let net_id = address.net_id.map(|number| number.to_string()).join(".");
    type_into(bench, "AMS Net ID", &net_id);
    // A machine that runs many tests at once is slow.
    type_into(bench, "Timeout (s)", "20");
}

/// Connected by the window, and armed.
fn connected(plant: &Plant, poses: usize) -> Bench {
    let (session, _) = planned(poses);
    let mut bench = Bench::of_session(&session);
    bench.go(Phase::Measuring);
    bench.settle("what to expect of the plan");
    fill(&mut bench, plant);
    bench.press("Connect");
    bench.wait("a connection", |state| state.model.link.is_connected());
    arm(&mut bench);
    bench
}

fn arm(bench: &mut Bench) {
    bench.press("Arm");
    bench.wait("arming", |state| state.model.link.is_armed());
}

#[test]
fn symbols_are_checked_one_by_one() {
    let plant = Plant::start(Style::Arrays);
    plant.server.order(json!({"remove": [global("force")]}));
    plant
        .server
        .order(json!({"declare": [[global("moving"), "LREAL", 1, [0]]]}));
    let (session, _) = planned(3);
    let mut bench = Bench::of_session(&session);
    bench.go(Phase::Measuring);
    bench.settle("what to expect of the plan");
    fill(&mut bench, &plant);
    bench.press("Symbols");
    bench.press("Check symbols");
    bench.settle("the symbols");
    bench.harness.step();
    for part in [
        "missing: Symbol not found",
        "wrong type: LREAL",
        "expected BOOL",
        "found: ",
    ] {
        assert!(shows(&bench, part), "{part}: {:?}", words(&bench.harness));
    }
    assert_eq!(plant.server.count("write"), 0);
    bench.press("Connect");
    bench.wait("a refusal", |state| !state.model.link.connecting);
    bench.harness.step();
    let why = "GVL_Tautline.moving is of type LREAL, expected BOOL";
    assert!(told(bench.state(), why) && shows(&bench, why));
    assert!(!bench.state().model.link.is_connected());
}

#[test]
fn a_reconnected_controller_is_disarmed_and_the_run_continues() {
    let plant = Plant::start(Style::Arrays);
    let mut bench = connected(&plant, 3);
    assert!(
        bench
            .harness
            .query_by_label("Speed of the simulation")
            .is_none(),
        "a real robot has its own time"
    );
    bench.press("Start measuring");
    bench.wait("two poses", |state| measured(state) == 2);
    // It does not let anybody in before its program runs again.
    plant.server.order(json!({"state": 6}));
    plant.server.fault("read", 1, "before");
    bench.wait("the loss", |state| state.model.link.lost().is_some());
    assert!(!bench.state().model.link.is_armed() && bench.state().model.link.is_measuring());
    bench.wait("the message", |state| told(state, "The robot is disarmed"));
    bench.wait("a failed attempt", |state| {
        let lost = state.model.link.lost();
        lost.is_some_and(|lost| lost.why.contains("does not run"))
    });
    assert!(shows(&bench, "Connection lost, reconnecting"));
    plant.server.order(json!({"state": 5}));
    bench.press("Reconnect now");
    bench.wait("the connection", |state| state.model.link.is_connected());
    bench.wait("the message", |state| {
        told(state, "Its values are unchanged")
    });
    assert!(
        !bench.state().model.link.is_armed(),
        "arming ended with the connection"
    );
    assert!(shows(
        &bench,
        "Waiting: the connection to the controller is lost"
    ));
    arm(&mut bench);
    assert_eq!(measured(bench.state()), 2, "arming moves nothing");
    bench.press("Resume");
    bench.wait("all poses", |state| !state.model.link.is_measuring());
    assert_eq!(measured(bench.state()), 3);
}

#[test]
fn a_connection_lost_while_writing_reports_what_the_controller_holds() {
    let plant = Plant::start(Style::Arrays);
    let mut bench = connected(&plant, 3);
    let held = bench.state().model.link.parameters[0].clone();
    // The old value is read before anything is written, so the first read after that comes with the new value.
    plant.server.fault("write", 2, "after");
    let values = vec![(held.name.clone(), held.value + 1e-3)];
    bench.give(RobotCommand::WriteValues(values, Purpose::Adjust));
    bench.wait("an outcome", |state| !state.model.link.writing);
    let settled = |state: &AppState| {
        let document = state.model.open.as_ref();
        let last = document.and_then(|d| d.session().adjustments().last());
        last.is_some_and(|last| !last.is_open())
    };
    bench.wait("the record", settled);
    bench.wait("the connection", |state| state.model.link.is_connected());
    let last = bench
        .session()
        .adjustments()
        .last()
        .expect("a record")
        .clone();
    let mut reader = plant.client();
    bench.give(LinkRequest::Disconnect);
    bench.give(FileCommand::Answer(Answer::Discard));
    bench.wait("the end", |state| !state.model.link.is_connected());
    tautline_link::Controller::connect(&mut reader).expect("connected");
    let now = tautline_link::Controller::read(&mut reader, &[held.name]).expect("a value");
    let expected = match last.outcome {
        Outcome::Written => held.value + 1e-3,
        _ => held.value,
    };
    assert!((now[0] - expected).abs() < 1e-9, "{now:?} after {last:?}");
}

#[test]
fn verification_poses_are_typed_without_an_instrument() {
    let plant = Plant::start(Style::Arrays);
    let mut bench = connected(&plant, 3);
    bench.go(Phase::Adjustment);
    bench.press("Measure before");
    let asked = |state: &AppState| match state.model.link.live().doing {
        RunStep::Locating { number, .. } => Some(number),
        _ => None,
    };
    for number in 1..=2 {
        bench.wait("a question", |state| asked(state) == Some(number));
        bench.harness.step();
        assert!(shows(&bench, "Where is the platform at"));
        let target = bench.state().model.link.targets[number - 1].pose.position;
        type_into(&mut bench, "Measured x", "far");
        assert!(shows(&bench, "expected a number"));
        for (k, axis) in ["x", "y", "z"].iter().enumerate() {
            let text = format!("{:.2}", target[k] * 1e3 + 1.0);
            type_into(&mut bench, &format!("Measured {axis}"), &text);
        }
        bench.press("Enter pose");
    }
    bench.wait("the third target", |state| asked(state) == Some(3));
    bench.press("Stop the robot");
    bench.wait("the end", |state| state.model.link.verifying.is_none());
    assert!(told(bench.state(), "stopped by the operator"));
}

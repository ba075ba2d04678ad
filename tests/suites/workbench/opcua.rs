//! Connecting to an encrypted OPC UA server in the window: the question of trust, the user, the lock.

use egui::Role;
use tautline_core::robot::presets;
use tautline_session::{Session, Timestamp};
use tautline_validation::support::ads::symbols::Style;
use tautline_validation::support::ads::{PASSWORD, Plant, Protocol, USER};
use tautline_validation::support::harness::words;
use tautline_workbench::model::command::{RobotCommand, Setup};
use tautline_workbench::model::phase::Phase;

use crate::demo::Bench;
use crate::support::type_into;

fn session() -> Session {
    let robot = presets::find("mini").expect("a preset").robot;
    Session::new("test", robot, Timestamp::from_unix_seconds(0))
}

/// The connection dialog with an address.
fn dialog(plant: &Plant) -> Bench {
    let mut bench = Bench::of_session(&session());
    bench.go(Phase::Measuring);
    bench.give(RobotCommand::Setup(Setup::Open));
    // A window that was opened takes its size.
    for _ in 0..3 {
        bench.harness.step();
    }
    bench.press("Controller with OPC UA");
    fill(&mut bench, "Address", &plant.server.url().url());
    fill(&mut bench, "Timeout (s)", "20");
    bench
}

fn fill(bench: &mut Bench, name: &str, text: &str) {
    type_into(&mut bench.harness, Role::TextInput, name, text);
}

fn shows(bench: &Bench, part: &str) -> bool {
    words(&bench.harness).iter().any(|text| text.contains(part))
}

#[test]
fn a_server_is_trusted_by_an_answer_and_its_user_types_a_password() {
    let plant = Plant::speaking(Protocol::OpcUaEncrypted, Style::Arrays);
    let mut bench = dialog(&plant);
    fill(&mut bench, "User", USER);
    fill(&mut bench, "Password", PASSWORD);
    bench.press("Connect");
    bench.wait("the question", |state| !state.model.link.connecting);
    bench.harness.step();
    let fingerprint = plant.server.fingerprint.expect("a certificate").to_string();
    assert!(shows(&bench, &fingerprint));
    bench.press("Trust this certificate");
    bench.wait("a connection", |state| state.model.link.is_connected());
    bench.harness.step();
    assert!(!shows(&bench, "not encrypted"));
    let place = bench
        .session()
        .connection
        .opcua
        .clone()
        .expect("an address");
    assert_eq!(place.user.as_deref(), Some(USER));
    let preferences = &bench.state().model.preferences;
    let stored = format!("{:?} {preferences:?}", bench.session());
    assert!(
        stored.contains("anna") && !stored.contains(PASSWORD),
        "{stored}"
    );
}

#[test]
fn a_connection_that_is_not_encrypted_has_a_mark() {
    let plant = Plant::speaking(Protocol::OpcUa, Style::Arrays);
    let mut bench = dialog(&plant);
    bench.press("Connect");
    bench.wait("a connection", |state| state.model.link.is_connected());
    bench.harness.step();
    assert!(shows(&bench, "not encrypted"));
}

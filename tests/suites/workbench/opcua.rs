//! Connecting to an encrypted OPC UA server in the window: the question of trust, the user, the lock.

use std::sync::Arc;

use egui::Role;
use serde_json::json;
use tautline_core::robot::presets;
use tautline_session::{Session, Timestamp};
use tautline_validation::support::ads::symbols::Style;
use tautline_validation::support::ads::{PASSWORD, Plant, Protocol, USER, user_certificates};
use tautline_validation::support::harness::words;
use tautline_validation::support::keyring::MemoryPasswords;
use tautline_validation::support::program::Folder;
use tautline_workbench::model::command::{RobotCommand, Setup, UserFile};
use tautline_workbench::model::phase::Phase;
use tautline_workflow::controllers::UserKeys;

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
    bench.press("Name and password");
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
fn a_password_is_kept_on_this_computer_until_it_is_forgotten() {
    let plant = Plant::speaking(Protocol::OpcUaEncrypted, Style::Arrays);
    let passwords = Arc::new(MemoryPasswords::default());
    let connect = |password: Option<&str>, keeps: bool| {
        let mut bench = dialog(&plant);
        bench.harness.state_mut().state.model.options.passwords = Some(passwords.clone());
        let keys = UserKeys::of(bench.state().model.folders.clone());
        let fingerprint = plant.server.fingerprint.expect("a certificate");
        let origin = plant.server.url().origin();
        keys.trust(&origin, fingerprint).expect("trusted");
        bench.press("Name and password");
        fill(&mut bench, "User", USER);
        if let Some(password) = password {
            fill(&mut bench, "Password", password);
        }
        if keeps {
            bench.press("Remember the password on this computer");
        }
        bench.press("Connect");
        bench.wait("an answer", |state| !state.model.link.connecting);
        bench
    };
    let wrong = connect(Some("wrong"), true);
    assert!(!wrong.state().model.link.is_connected());
    drop(wrong);
    assert_eq!(passwords.accounts(), []);
    let mut kept = connect(Some(PASSWORD), true);
    assert!(kept.state().model.link.is_connected());
    kept.wait("the keyring", |_| !passwords.accounts().is_empty());
    drop(kept);
    let accounts = passwords.accounts();
    let origin = plant.server.url().origin();
    assert_eq!(accounts.len(), 1);
    assert_eq!(
        (&accounts[0].server, accounts[0].user.as_str()),
        (&origin, USER)
    );
    let mut found = connect(None, false);
    assert!(found.state().model.link.is_connected(), "without typing it");
    found.give(RobotCommand::Setup(Setup::Open));
    for _ in 0..3 {
        found.harness.step();
    }
    found.press("Forget it");
    found.wait("the keyring", |_| passwords.accounts().is_empty());
    found.harness.step();
    drop(found);
    assert!(!connect(None, false).state().model.link.is_connected());
}

#[test]
fn a_user_signs_in_with_a_certificate_and_its_key_stays_in_its_file() {
    let users = Folder::new();
    user_certificates(users.path());
    let (certificate, key) = (users.join("anna.pem"), users.join("pkcs8.pem"));
    let security = json!({
        "policies": ["Basic256Sha256_SignAndEncrypt"],
        "certified": [certificate],
    });
    let plant = Plant::with_security(&security, Style::Arrays);
    let mut bench = dialog(&plant);
    bench.press("Certificate");
    fill(&mut bench, "User certificate", &certificate);
    let take = Setup::TakeUserFile(UserFile::Key, users.join("encrypted.pem").into());
    bench.give(RobotCommand::Setup(take));
    bench.press("Connect");
    bench.wait("a refusal", |state| !state.model.link.connecting);
    bench.harness.step();
    assert!(shows(&bench, "openssl pkey -in"));
    fill(&mut bench, "Private key", &key);
    bench.press("Connect");
    bench.wait("the question", |state| !state.model.link.connecting);
    bench.harness.step();
    bench.press("Trust this certificate");
    bench.wait("a connection", |state| state.model.link.is_connected());
    bench.harness.step();
    let place = bench.session().connection.opcua.clone();
    let files = place.expect("an address").user_certificate.expect("files");
    assert_eq!([&files.certificate, &files.key], [&certificate, &key]);
    let secret = std::fs::read_to_string(&key).expect("a key");
    let line = secret.lines().nth(1).expect("a line");
    let preferences = &bench.state().model.preferences;
    let stored = format!("{:?} {preferences:?}", bench.session());
    assert!(!stored.contains(line), "{stored}");
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

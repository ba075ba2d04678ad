//! What is found when a connection is made, and what a client may do before and after it is armed.

use serde_json::json;
use tautline_core::geometry::Pose;
use tautline_link::ads::AdsOptions;
use tautline_link::{Activity, Controller, LinkError};

use tautline_validation::ads::Plant;
use tautline_validation::ads::symbols::{Style, global};

fn refused(order: serde_json::Value) -> String {
    let plant = Plant::start(Style::Arrays);
    plant.server.order(order);
    let mut client = plant.client();
    let told = client.connect().expect_err("it cannot be used").to_string();
    assert_eq!(client.state().activity, Activity::Disconnected);
    assert_eq!(plant.server.count("write"), 0);
    told
}

#[test]
fn missing_symbols_are_named() {
    let told = refused(json!({"remove": [global("force"), global("home")]}));
    assert!(told.contains("2 of the symbols"), "{told}");
    assert!(
        told.contains("GVL_Tautline.force: Symbol not found (ADS error 0x710)"),
        "{told}"
    );
    assert!(told.contains("GVL_Tautline.home"), "{told}");
}

#[test]
fn a_symbol_of_the_wrong_type_is_named() {
    let told = refused(json!({"declare": [[global("moving"), "LREAL", 1, [0]]]}));
    let expected = "GVL_Tautline.moving is of type LREAL, expected BOOL";
    assert!(told.contains(expected), "{told}");
    let told = refused(json!({"declare": [[global("laser"), "STRING", 1, [""]]]}));
    let expected = "GVL_Tautline.laser is of type STRING(80), expected a number";
    assert!(told.contains(expected), "{told}");
}

#[test]
fn an_array_of_the_wrong_length_is_named() {
    let told =
        refused(json!({"declare": [[global("revolutions"), "LREAL", 6, [0, 0, 0, 0, 0, 0]]]}));
    assert!(told.contains("has 6 values, expected 8"), "{told}");
}

#[test]
fn a_stopped_program_is_reported_at_connection() {
    let told = refused(json!({"state": 6}));
    assert!(told.contains("its state is \"Stop\""), "{told}");
}

#[test]
fn numbers_of_every_type_are_read() {
    let plant = Plant::start(Style::Arrays);
    for (kind, raw) in [
        ("BOOL", 1.0),
        ("SINT", -3.0),
        ("INT", 300.0),
        ("DINT", 70_000.0),
        ("ULINT", 5e9),
        ("REAL", 0.5),
    ] {
        plant
            .server
            .order(json!({"declare": [[global("temperature"), kind, 1, [raw]]]}));
        let mut client = plant.client();
        client.connect().expect("connected");
        let sample = client.sample().expect("a sample");
        assert_eq!(sample.temperature_c, Some(raw), "{kind}");
    }
}

#[test]
fn nothing_is_written_before_arming() {
    let plant = Plant::start(Style::Arrays);
    let mut client = plant.client();
    assert!(client.sample().is_err_and(|e| e.is_disconnection()));
    client.connect().expect("connected");
    for _ in 0..3 {
        client.sample().expect("a sample");
    }
    client.parameters().expect("parameters");
    client.stop().expect("nothing moves");
    let centre = plant.preset.workspace.centre;
    assert_eq!(client.command(&centre), Err(LinkError::NotArmed));
    assert_eq!(client.home(), Err(LinkError::NotArmed));
    let value = [("home.x_m".to_owned(), 0.0)];
    assert_eq!(client.write(&value), Err(LinkError::NotArmed));
    client.disarm();
    plant
        .server
        .order(json!({"set": {global("moving"): [true]}}));
    client.sample().expect("a sample");
    let told = client.stop().expect_err("another moves it").to_string();
    assert!(told.contains("not armed here"), "{told}");
    client.disconnect();
    drop(client);
    assert_eq!(plant.server.count("write"), 0);
}

#[test]
fn arming_and_disarming_reach_the_controller() {
    let plant = Plant::start(Style::Arrays);
    let mut client = plant.armed();
    assert!(client.state().armed);
    assert_eq!(plant.server.count("write"), 1, "the release");
    client.sample().expect("a sample");
    assert_eq!(plant.server.count("write"), 2, "the watchdog");
    client.disarm();
    assert_eq!(plant.server.count("write"), 3, "the release is taken back");
    client.sample().expect("a sample");
    assert_eq!(plant.server.count("write"), 3);
}

#[test]
fn arming_ends_with_the_connection() {
    let plant = Plant::start(Style::Arrays);
    let mut client = plant.armed();
    plant.server.fault("read", 1, "before");
    assert!(client.sample().is_err_and(|e| e.is_disconnection()));
    let state = client.state();
    assert_eq!(
        (state.activity, state.armed),
        (Activity::Disconnected, false)
    );
    client.connect().expect("connected again");
    assert!(!client.state().armed);
    assert_eq!(client.home(), Err(LinkError::NotArmed));
}

#[test]
fn a_command_that_waits_or_a_fault_prevents_arming() {
    let plant = Plant::start(Style::Arrays);
    let mut client = plant.client();
    client.connect().expect("connected");
    plant.server.order(json!({"set": {global("number"): [8]}}));
    let told = client.arm().expect_err("a command waits").to_string();
    assert!(told.contains("command 8 is pending"), "{told}");
    plant.server.order(json!({"set": {
        global("number"): [7], global("fault"): [3], global("fault_text"): ["drive 4 is hot"]}}));
    let told = client.arm().expect_err("a fault").to_string();
    assert!(told.contains("drive 4 is hot (code 3)"), "{told}");
    assert!(!client.state().armed);
    assert_eq!(plant.server.count("write"), 0);
}

#[test]
fn limits_are_kept_on_our_side() {
    let plant = Plant::start(Style::Arrays);
    let mut client = plant.armed();
    let writes = plant.server.count("write");
    let mut far = Pose::identity();
    far.position.x = 5.0;
    assert!(matches!(client.command(&far), Err(LinkError::Limit(_))));
    assert_eq!(plant.server.count("write"), writes);
}

#[test]
fn an_unacknowledged_command_becomes_a_fault() {
    let plant = Plant::start(Style::Arrays);
    // Nobody copies the number of this client's commands.
    plant
        .server
        .order(json!({"declare": [[global("taken"), "UDINT", 1, [7]]]}));
    let mut mapping =
        tautline_validation::ads::symbols::mapping(&plant.preset.robot, Style::Arrays);
    if let Some(command) = &mut mapping.command {
        command.acknowledged = global("taken");
    }
    let options = AdsOptions {
        timeout_s: 20.0,
        acknowledge_s: 0.0,
        ..AdsOptions::default()
    };
    let clock = std::sync::Arc::new(tautline_link::SystemClock::start());
    let robot = &plant.preset.robot;
    let mut client = tautline_link::ads::AdsController::new(
        plant.server.address(),
        &mapping,
        robot,
        options,
        clock,
    )
    .expect("a controller");
    client.connect().expect("connected");
    client.arm().expect("armed");
    client.home().expect("told");
    assert_eq!(client.state().activity, Activity::Moving);
    client.sample().expect("a sample");
    let Activity::Fault(told) = client.state().activity else {
        panic!("no fault");
    };
    assert!(told.contains("did not acknowledge command 8"), "{told}");
}

#[test]
fn a_withdrawn_release_disarms() {
    let plant = Plant::start(Style::Arrays);
    let mut client = plant.armed();
    client.sample().expect("a sample");
    plant
        .server
        .order(json!({"set": {global("release"): [false]}}));
    client.sample().expect("a sample");
    let state = client.state();
    let Activity::Fault(told) = state.activity else {
        panic!("no fault");
    };
    assert!(
        told.contains("revoked the release") && !state.armed,
        "{told}"
    );
    assert!(client.home().is_err());
    client.arm().expect("armed again");
    client.sample().expect("a sample");
    assert!(client.state().armed);
    // Whoever arms again before that was noticed has armed.
    plant
        .server
        .order(json!({"set": {global("release"): [false]}}));
    client.arm().expect("armed again");
    client.sample().expect("a sample");
    assert!(client.state().armed);
}

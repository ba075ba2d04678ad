//! Checks when a connection is made, and permissions of a client before and after arming.

use serde_json::json;
use tautline_core::geometry::Pose;
use tautline_link::ads::AdsOptions;
use tautline_link::{Activity, Controller, LinkError};

use tautline_validation::support::ads::symbols::{Style, global};
use tautline_validation::support::ads::{Host, Plant, Protocol};

fn refused(protocol: Protocol, order: serde_json::Value) -> String {
    let plant = Plant::speaking(protocol, Style::Arrays);
    plant.server.order(order);
    let mut client = plant.client();
    let told = client.connect().expect_err("it cannot be used").to_string();
    assert_eq!(client.state().activity, Activity::Disconnected);
    assert_eq!(plant.server.count("write"), 0);
    told
}

#[test]
fn missing_symbols_are_named() {
    let told = refused(
        Protocol::Ads,
        json!({"remove": [global("force"), global("home")]}),
    );
    assert!(told.contains("2 of the symbols"), "{told}");
    assert!(
        told.contains("GVL_Tautline.force: Symbol not found (ADS error 0x710)"),
        "{told}"
    );
    assert!(told.contains("GVL_Tautline.home"), "{told}");
}

#[test]
fn a_symbol_of_the_wrong_type_is_named() {
    let told = refused(
        Protocol::Ads,
        json!({"declare": [[global("moving"), "LREAL", 1, [0]]]}),
    );
    let expected = "GVL_Tautline.moving is of type LREAL, expected BOOL";
    assert!(told.contains(expected), "{told}");
    let told = refused(
        Protocol::Ads,
        json!({"declare": [[global("laser"), "STRING", 1, [""]]]}),
    );
    let expected = "GVL_Tautline.laser is of type STRING(80), expected a number";
    assert!(told.contains(expected), "{told}");
}

fn an_array_of_the_wrong_length_is_named(protocol: Protocol) {
    let told = refused(
        protocol,
        json!({"declare": [[global("revolutions"), "LREAL", 6, [0, 0, 0, 0, 0, 0]]]}),
    );
    assert!(told.contains("has 6 values, expected 8"), "{told}");
}

fn a_stopped_program_is_reported_at_connection(protocol: Protocol) {
    let (number, state) = match protocol {
        Protocol::Ads => (6, "Stop"),
        Protocol::OpcUa | Protocol::OpcUaEncrypted => (3, "Suspended"),
    };
    let told = refused(protocol, json!({ "state": number }));
    assert!(
        told.contains(&format!("its state is \"{state}\"")),
        "{told}"
    );
}

fn numbers_of_every_type_are_read(protocol: Protocol) {
    let plant = Plant::speaking(protocol, Style::Arrays);
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

fn nothing_is_written_before_arming(protocol: Protocol) {
    let plant = Plant::speaking(protocol, Style::Arrays);
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

fn arming_and_disarming_reach_the_controller(protocol: Protocol) {
    let plant = Plant::speaking(protocol, Style::Arrays);
    let mut client = plant.armed();
    assert!(client.state().armed);
    let armed = plant.server.count("write");
    assert!(
        armed > 3,
        "the release, and the watchdog while it is confirmed"
    );
    client.sample().expect("a sample");
    assert_eq!(plant.server.count("write"), armed + 1, "the watchdog");
    client.disarm();
    assert_eq!(
        plant.server.count("write"),
        armed + 2,
        "the release is taken back"
    );
    client.sample().expect("a sample");
    assert_eq!(plant.server.count("write"), armed + 2);
}

fn arming_ends_with_the_connection(protocol: Protocol) {
    let plant = Plant::speaking(protocol, Style::Arrays);
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

fn a_command_that_waits_or_a_fault_prevents_arming(protocol: Protocol) {
    let plant = Plant::speaking(protocol, Style::Arrays);
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

fn limits_are_kept_on_our_side(protocol: Protocol) {
    let plant = Plant::speaking(protocol, Style::Arrays);
    let mut client = plant.armed();
    let writes = plant.server.count("write");
    let mut far = Pose::identity();
    far.position.x = 5.0;
    assert!(matches!(client.command(&far), Err(LinkError::Limit(_))));
    assert_eq!(plant.server.count("write"), writes);
}

fn an_unacknowledged_command_becomes_a_fault(protocol: Protocol) {
    let plant = Plant::speaking(protocol, Style::Arrays);
    // Nobody copies the number of this client's commands.
    plant
        .server
        .order(json!({"declare": [[global("taken"), "UDINT", 1, [7]]]}));
    let mut mapping =
        tautline_validation::support::ads::symbols::mapping(&plant.preset.robot, Style::Arrays);
    if let Some(command) = &mut mapping.command {
        command.acknowledged = global("taken");
    }
    let options = AdsOptions {
        timeout_s: 20.0,
        acknowledge_s: 0.0,
        ..AdsOptions::default()
    };
    let robot = &plant.preset.robot;
    let mut client = plant.server.client(&mapping, robot, options);
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

fn a_withdrawn_release_disarms(protocol: Protocol) {
    let plant = Plant::speaking(protocol, Style::Arrays);
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
    // A client that arms again before this was noticed is armed.
    plant
        .server
        .order(json!({"set": {global("release"): [false]}}));
    client.arm().expect("armed again");
    client.sample().expect("a sample");
    assert!(client.state().armed);
}

super::over_all! {
    an_array_of_the_wrong_length_is_named,
    numbers_of_every_type_are_read,
    nothing_is_written_before_arming,
    arming_and_disarming_reach_the_controller,
    arming_ends_with_the_connection,
    a_command_that_waits_or_a_fault_prevents_arming,
    limits_are_kept_on_our_side,
    an_unacknowledged_command_becomes_a_fault,
    a_withdrawn_release_disarms,
    a_stopped_program_is_reported_at_connection,
}

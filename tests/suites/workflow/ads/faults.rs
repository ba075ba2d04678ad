//! Slow answers, broken connections, error codes, restarts.

use serde_json::json;
use tautline_link::ads::AdsOptions;
use tautline_link::measuring::{MeasuringEvent, MeasuringOptions, MeasuringRun};
use tautline_link::reconnecting::{BackOff, Reconnect, Reconnected};
use tautline_link::{Activity, Controller};

use tautline_validation::support::ads::symbols::{Style, global};
use tautline_validation::support::ads::{Plant, Protocol};

fn a_slow_server_is_waited_for(protocol: Protocol) {
    let plant = Plant::speaking(protocol, Style::Arrays);
    let mut client = plant.armed();
    plant.server.order(json!({"delay_s": 0.1}));
    for _ in 0..3 {
        client.sample().expect("a late sample");
    }
    assert!(client.state().armed);
}

fn a_late_answer_is_never_matched_with_another_request(protocol: Protocol) {
    let plant = Plant::speaking(protocol, Style::Arrays);
    let mut client = plant.client_with(AdsOptions {
        timeout_s: 2.0,
        ..AdsOptions::default()
    });
    client.connect().expect("connected");
    client.arm().expect("armed");
    plant
        .server
        .order(json!({"delay_s": 4.0, "set": {global("temperature"): [11.0]}}));
    let told = client.sample().expect_err("a late answer").to_string();
    let expected = "the controller did not answer within 2 s when asked to read ";
    assert!(told.starts_with(expected), "{told}");
    // The connection ended with it, and arming.
    assert_eq!(client.state().activity, Activity::Disconnected);
    assert!(!client.state().armed);
    plant
        .server
        .order(json!({"delay_s": 0.0, "set": {global("temperature"): [22.0]}}));
    client.connect().expect("connected again");
    let sample = client.sample().expect("a sample");
    assert_eq!(sample.temperature_c, Some(22.0));
}

fn a_connection_lost_while_reading_is_reported_and_reopened(protocol: Protocol) {
    for action in ["before", "after", "half"] {
        let plant = Plant::speaking(protocol, Style::Arrays);
        let mut client = plant.armed();
        let held = client.parameters().expect("parameters");
        plant.server.fault("read", 1, action);
        let told = client.parameters().expect_err("a broken connection");
        assert!(told.is_disconnection(), "{action}: {told}");
        assert_eq!(client.state().activity, Activity::Disconnected);
        client.connect().expect("connected again");
        assert_eq!(client.parameters().expect("parameters"), held);
    }
}

fn parameters_that_another_client_writes_show_at_the_end_of_a_run(protocol: Protocol) {
    let plant = Plant::speaking(protocol, Style::Arrays);
    let mut client = plant.armed();
    let robot = &plant.preset.robot;
    let home = robot.home.expect("a home pose").pose();
    let mut run = MeasuringRun::new(vec![(0, home)], robot, MeasuringOptions::of(robot));
    let events = run.tick(&mut client, 0.0);
    let [MeasuringEvent::ValuesAtStart(before)] = &events[..] else {
        panic!("{events:?}");
    };
    let drums = vec![0.05; robot.cable_count()];
    plant
        .server
        .order(json!({"set": {global("drum_diameter"): drums}}));
    run.abort(&mut client).expect("stopped");
    let read = run.values_at_end(&mut client);
    let Some(MeasuringEvent::ValuesAtEnd(after)) = read else {
        panic!("{read:?}");
    };
    let pairs = before.iter().zip(&after);
    let changed = pairs.filter(|(before, after)| before.value != after.value);
    let changed: Vec<&str> = changed.map(|(before, _)| before.name.as_str()).collect();
    assert_eq!(changed.len(), robot.cable_count(), "{changed:?}");
    assert!(
        changed
            .iter()
            .all(|name| name.ends_with(".winch.drum_diameter_m"))
    );
}

#[test]
fn an_answer_to_another_request_ends_the_connection() {
    let plant = Plant::start(Style::Arrays);
    let mut client = plant.armed();
    plant.server.fault("read", 1, "stray");
    let told = client.sample().expect_err("not our answer");
    assert!(told.is_disconnection(), "{told}");
    assert!(told.to_string().contains("is invalid"), "{told}");
}

#[test]
fn connections_lost_while_symbols_are_looked_up_are_reported() {
    let plant = Plant::start(Style::Arrays);
    let mut client = plant.client();
    for (kind, number) in [
        ("state", 1),
        ("lookup", 1),
        ("lookup", 9),
        ("read", 1),
        ("read", 2),
    ] {
        plant.server.fault(kind, number, "half");
        let told = client.connect().expect_err("a broken connection");
        assert!(told.is_disconnection(), "{kind} {number}: {told}");
        assert_eq!(client.state().activity, Activity::Disconnected);
    }
    client.connect().expect("connected");
}

fn a_restarted_controller_is_reconnected(protocol: Protocol) {
    let plant = Plant::speaking(protocol, Style::Arrays);
    let mut client = plant.armed();
    let held = client.parameters().expect("parameters");
    plant.server.order(json!({"restart": 0.2}));
    let told = client.sample().expect_err("it restarted");
    assert!(told.is_disconnection(), "{told}");
    let mut reconnect = Reconnect::new(BackOff::default());
    let mut now_s = 0.0;
    while reconnect.tick(&mut client, now_s) != Reconnected::Connected {
        now_s += 1.0;
        assert!(now_s < 100.0, "it does not come back");
    }
    // Everything is elsewhere now, and found there.
    assert_eq!(client.parameters().expect("parameters"), held);
    assert!(!client.state().armed);
}

#[test]
fn a_replaced_program_is_noticed_before_any_access_to_a_wrong_address() {
    for reads in [true, false] {
        let plant = Plant::start(Style::Arrays);
        let mut client = plant.armed();
        let writes = plant.server.count("write");
        plant.server.order(json!({"move": true}));
        let told = match reads {
            true => client.sample().map(drop),
            false => client.write(&[("home.x_m".to_owned(), 0.0)]),
        };
        let told = told.expect_err("another program").to_string();
        assert!(told.contains("program was changed"), "{told}");
        assert_eq!(plant.server.count("write"), writes);
        client.connect().expect("connected again");
        client.sample().expect("a sample");
    }
}

#[test]
fn a_node_that_does_not_hold_what_it_held_is_named() {
    let name = global("temperature");
    for (order, found) in [
        (
            json!({"declare": [[name, "STRING", 1, [""]]]}),
            "a value of type String",
        ),
        (json!({ "null": [name] }), "no value (null)"),
    ] {
        let plant = Plant::speaking(Protocol::OpcUa, Style::Arrays);
        let mut client = plant.client();
        client.connect().expect("connected");
        plant.server.order(order);
        let told = client.sample().expect_err("another value").to_string();
        let expected = format!("its node ns=4;s={name} sent {found}, expected Double");
        assert!(told.contains(&expected), "{told}");
        assert!(told.contains("connect again"), "{told}");
    }
}

#[test]
fn a_server_without_sum_requests_gets_single_requests() {
    let plant = Plant::start(Style::Arrays);
    let mut client = plant.armed();
    let before = client.parameters().expect("parameters");
    plant.server.order(json!({"sums": false}));
    assert_eq!(client.parameters().expect("parameters"), before);
    let changed = [
        ("home.x_m".to_owned(), 0.01),
        ("home.y_m".to_owned(), -0.01),
    ];
    client.write(&changed).expect("written");
    let names = changed.clone().map(|(name, _)| name);
    assert_eq!(client.read(&names).expect("values"), [0.01, -0.01]);
}

#[test]
fn error_codes_are_reported_with_symbol_and_meaning() {
    let plant = Plant::start(Style::Arrays);
    let mut client = plant.armed();
    for (code, meaning) in [
        (0x723, "Access denied"),
        (0x719, "Device has a timeout"),
        (0x9999, "unknown error"),
    ] {
        plant
            .server
            .order(json!({"codes": {global("force"): code, global("home"): code}}));
        let told = client.sample().expect_err("an error").to_string();
        let expected =
            format!("the controller refused: GVL_Tautline.force: {meaning} (ADS error {code:#x})");
        assert_eq!(told, expected);
        let told = client
            .write(&[("home.x_m".to_owned(), 0.0)])
            .expect_err("an error");
        let expected =
            format!("the controller refused: GVL_Tautline.home: {meaning} (ADS error {code:#x})");
        assert_eq!(told.to_string(), expected);
        assert!(client.state().armed, "the connection is well");
    }
    plant.server.order(json!({"codes": {}}));
    client.sample().expect("a sample");
}

#[test]
fn a_program_that_stops_is_reported() {
    let plant = Plant::start(Style::Arrays);
    let mut client = plant.armed();
    plant.server.order(json!({"state": 6}));
    // It is asked for its state whenever it is armed, and once a second.
    let told = client.arm().expect_err("it does not run").to_string();
    assert!(told.contains("its state is \"Stop\""), "{told}");
    assert!(matches!(client.state().activity, Activity::Fault(_)));
}

super::over_all! {
    a_slow_server_is_waited_for,
    a_late_answer_is_never_matched_with_another_request,
    a_connection_lost_while_reading_is_reported_and_reopened,
    a_restarted_controller_is_reconnected,
    parameters_that_another_client_writes_show_at_the_end_of_a_run,
}

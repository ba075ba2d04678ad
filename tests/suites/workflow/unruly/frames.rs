//! Invalid answers: a client trusts no length, waits no longer than its timeout, and never panics.

use std::time::{Duration, Instant};

use tautline_link::ads::AdsOptions;
use tautline_link::{Controller, LinkError};
use tautline_validation::support::ads::Plant;
use tautline_validation::support::ads::unruly::{Action, RequestKind, Unruly};

use super::client;

/// Long enough for a machine that runs many tests at once, short enough for a test.
const TIMEOUT_S: f64 = 1.5;

fn drums() -> Vec<String> {
    let cables = 1..=8;
    cables
        .map(|n| format!("cable-{n}.winch.drum_diameter_m"))
        .collect()
}

fn is_lost<T>(answer: Result<T, LinkError>, at: &Action) -> String {
    let error = answer
        .err()
        .unwrap_or_else(|| panic!("{at:?}: it is believed"));
    let lost = error.is_disconnection() || matches!(error, LinkError::Timeout { .. });
    assert!(lost, "{at:?}: {error}");
    error.to_string()
}

/// Reads parameters while a fault happens, and again after it.
fn read_with(plant: &Plant<Unruly>, action: Action) -> String {
    let mut client = client(plant);
    let expected = client.read(&drums()).expect("values");
    assert!(
        expected.iter().all(|diameter| *diameter > 0.01),
        "{expected:?}"
    );
    plant.server.fault(RequestKind::Read, 1, action.clone());
    let told = is_lost(client.read(&drums()), &action);
    assert!(!client.state().armed);
    client.connect().expect("connected again");
    assert_eq!(client.read(&drums()), Ok(expected), "{action:?}");
    told
}

#[test]
fn short_long_and_padded_answers_are_not_believed() {
    let plant = Plant::unruly();
    // Down to the error code alone.
    for missing in [1, 8, 63, 64, 1000] {
        for action in [Action::Short(missing), Action::Less(missing)] {
            let told = read_with(&plant, action);
            assert!(told.contains("its answer is invalid"), "{told}");
        }
    }
    for zeros in [1, 8, 4096] {
        let told = read_with(&plant, Action::Padded(zeros));
        assert!(told.contains("its answer is invalid"), "{told}");
    }
}

#[test]
fn short_answers_are_not_believed_in_samples_and_descriptions_either() {
    let plant = Plant::unruly();
    let mut robot = client(&plant);
    for action in [Action::Short(8), Action::Padded(8)] {
        plant.server.fault(RequestKind::Read, 1, action.clone());
        is_lost(robot.sample(), &action);
        robot.connect().expect("connected again");
    }
    robot.disconnect();
    for action in [Action::Short(1), Action::Padded(1), Action::Less(12)] {
        plant.server.fault(RequestKind::Lookup, 3, action.clone());
        is_lost(robot.connect(), &action);
    }
    robot.connect().expect("connected");
}

#[test]
fn lengths_of_frames_are_checked_before_anything_is_allocated() {
    let plant = Plant::unruly();
    for length in [0, 1, 23, 24, 31, 1 << 30, u32::MAX] {
        let told = read_with(&plant, Action::Length(length));
        assert!(told.contains("its answer is invalid"), "{length}: {told}");
    }
    for length in [0, 23, u32::MAX] {
        let action = Action::Length(length);
        plant.server.fault(RequestKind::State, 1, action.clone());
        let told = is_lost(plant.client().connect(), &action);
        assert!(told.contains("does not speak ADS"), "{told}");
    }
}

#[test]
fn what_nobody_asked_for_is_passed_over() {
    let plant = Plant::unruly();
    let mut client = client(&plant);
    let expected = client.read(&drums()).expect("values");
    plant
        .server
        .fault(RequestKind::Read, 1, Action::Notifications);
    assert_eq!(client.read(&drums()), Ok(expected));
}

#[test]
fn an_exchange_ends_in_time_whatever_arrives() {
    // All of them wait for the deadline, each on a server of its own.
    std::thread::scope(|scope| {
        for action in [Action::Notes, Action::Dripping, Action::Late(30_000)] {
            for kind in [
                Some(RequestKind::State),
                Some(RequestKind::Lookup),
                Some(RequestKind::Read),
                None,
            ] {
                let action = action.clone();
                scope.spawn(move || ends_in_time(&action, kind));
            }
        }
    });
}

/// Connects while an answer of this kind goes wrong; without one a sample, once connected.
fn ends_in_time(action: &Action, kind: Option<RequestKind>) {
    let plant = Plant::unruly();
    let options = AdsOptions {
        timeout_s: TIMEOUT_S,
        ..AdsOptions::default()
    };
    // Far more than the deadline, far less than the answer would take: a byte every half second, or never.
    let patience = Duration::from_secs(15);
    let mut robot = plant.client_with(options);
    if kind.is_none() {
        robot.connect().expect("connected");
    }
    plant
        .server
        .fault(kind.unwrap_or(RequestKind::Read), 1, action.clone());
    let begun = Instant::now();
    let told = match kind {
        Some(_) => is_lost(robot.connect(), action),
        None => is_lost(robot.sample(), action),
    };
    let taken = begun.elapsed();
    assert!(taken < patience, "{action:?} {kind:?}: {taken:?}");
    assert!(told.contains("did not answer within 1.5 s"), "{told}");
}

#[test]
fn errors_of_the_router_are_told_with_their_meaning() {
    let plant = Plant::unruly();
    for (code, meaning) in [
        (
            0x7,
            "Target machine not found, possibly missing ADS routes (ADS error 0x7)",
        ),
        (
            0x745,
            "Timeout elapsed: check route setting (ADS error 0x745)",
        ),
    ] {
        let mut client = client(&plant);
        plant.server.fault(RequestKind::Read, 1, Action::Code(code));
        let told = client.sample().expect_err("an error").to_string();
        assert!(told.contains(meaning), "{told}");
    }
}

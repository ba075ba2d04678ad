//! Readings that a controller sends on its own: they are for display, and no decision depends on them.

use std::time::{Duration, Instant};

use tautline_link::{Controller, LinkError, Sample};
use tautline_validation::support::ads::Plant;
use tautline_validation::support::ads::symbols::global;
use tautline_validation::support::ads::unruly::{Action, RequestKind, Unruly};

use super::client;

/// Interval between two readings that are sent (s).
const CYCLE_S: f64 = 0.01;
/// Time limit for expected messages.
const PATIENCE: Duration = Duration::from_secs(60);

/// A controller whose time runs by the clock.
fn running() -> Plant<Unruly> {
    let plant = Plant::unruly();
    plant.server.run_clock(&global("time"), Instant::now());
    plant
}

/// Waits for at least `count` readings that the controller sends.
fn sent(client: &mut impl Controller, count: usize) -> Vec<Sample> {
    let begun = Instant::now();
    let mut all = Vec::new();
    while all.len() < count {
        assert!(begun.elapsed() < PATIENCE, "{} arrived", all.len());
        all.extend(client.sent().expect("a connection"));
        std::thread::sleep(Duration::from_millis(5));
    }
    all
}

#[test]
fn what_is_sent_is_what_is_read() {
    let plant = running();
    let mut client = client(&plant);
    client.subscribe(CYCLE_S).expect("it sends");
    let mut samples = sent(&mut client, 20);
    let read = client.sample().expect("a reading");
    samples.extend(sent(&mut client, 20));
    let order = samples
        .windows(2)
        .all(|pair| pair[0].time_s < pair[1].time_s);
    assert!(order, "{samples:?}");
    for sample in &samples {
        // The platform stands still: only the time differs. The start of the controller is part of its state, not of readings.
        let same = Sample {
            time_s: read.time_s,
            started: read.started,
            ..sample.clone()
        };
        assert_eq!(same, read);
    }
    client.disconnect();
    assert_eq!(plant.server.subscriptions(), 0);
}

#[test]
fn answers_are_found_among_what_is_sent() {
    let plant = running();
    let mut client = client(&plant);
    client.subscribe(0.001).expect("it sends");
    // Nobody takes them meanwhile.
    for _ in 0..200 {
        client.sample().expect("a reading");
    }
    assert!(!sent(&mut client, 1).is_empty());
    plant
        .server
        .fault(RequestKind::Read, 1, Action::Notifications);
    client.sample().expect("a reading");
    sent(&mut client, 10);
}

#[test]
fn a_controller_that_sends_nothing_is_only_read() {
    let plant = running();
    let mut client = client(&plant);
    plant
        .server
        .fault(RequestKind::Lookup, 3, Action::Code(0x701));
    let refused = client.subscribe(CYCLE_S);
    assert!(matches!(refused, Err(LinkError::Refused(_))), "{refused:?}");
    // Those that it had taken were ended.
    assert_eq!(plant.server.subscriptions(), 0);
    client.sample().expect("a reading");
    assert_eq!(client.sent(), Ok(Vec::new()));
}

#[test]
fn a_lost_connection_shows_and_ends_them() {
    let plant = running();
    let mut client = client(&plant);
    client.subscribe(CYCLE_S).expect("it sends");
    sent(&mut client, 1);
    plant.server.down();
    let begun = Instant::now();
    while client.sent().is_ok() {
        assert!(begun.elapsed() < PATIENCE);
        std::thread::sleep(Duration::from_millis(5));
    }
    assert!(!client.state().armed);
    plant.server.up();
    client.connect().expect("connected again");
    client.sample().expect("a reading");
    assert_eq!(client.sent(), Ok(Vec::new()));
    client.subscribe(CYCLE_S).expect("it sends");
    sent(&mut client, 1);
}

//! Readings that a controller sends on its own, from independent servers.

use std::time::{Duration, Instant};

use tautline_link::{Controller, Sample};
use tautline_validation::support::ads::symbols::Style;
use tautline_validation::support::ads::{Plant, Protocol};

/// Interval between two readings that are sent (s).
const CYCLE_S: f64 = 0.01;
/// Time limit for expected messages.
const PATIENCE: Duration = Duration::from_secs(60);

/// Samples until `count` were sent: the polled ones, and those that the controller sent.
fn samples(client: &mut dyn Controller, count: usize) -> (Vec<Sample>, Vec<Sample>) {
    let begun = Instant::now();
    let (mut asked, mut sent) = (Vec::new(), Vec::new());
    while sent.len() < count {
        assert!(begun.elapsed() < PATIENCE, "{} were sent", sent.len());
        asked.push(client.sample().expect("a sample"));
        std::thread::sleep(Duration::from_millis(20));
        sent.extend(client.sent().expect("a connection"));
    }
    (asked, sent)
}

#[test]
fn what_opc_ua_sends_is_what_is_read() {
    what_is_sent_is_what_is_read(Protocol::OpcUa);
}

#[test]
fn what_encrypted_opc_ua_sends_is_what_is_read() {
    what_is_sent_is_what_is_read(Protocol::OpcUaEncrypted);
}

/// The time of the controller advances with each polled sample.
fn what_is_sent_is_what_is_read(protocol: Protocol) {
    let plant = Plant::speaking(protocol, Style::Arrays);
    let mut client = plant.armed();
    client.subscribe(CYCLE_S).expect("it sends");
    let (asked, sent) = samples(&mut client, 10);
    let times = sent.windows(2).map(|pair| pair[1].time_s - pair[0].time_s);
    assert!(times.into_iter().all(|step| step > 0.0), "{sent:?}");
    let mut compared = 0;
    for sample in &sent {
        let Some(read) = asked.iter().find(|read| read.time_s == sample.time_s) else {
            continue;
        };
        // The start of the controller is part of its state, not of the shown readings.
        let sample = Sample {
            started: read.started,
            ..sample.clone()
        };
        assert_eq!(sample, *read);
        compared += 1;
    }
    assert!(compared >= 5, "{compared} of {}", sent.len());
    // A second subscription replaces the first.
    client.subscribe(CYCLE_S).expect("it sends");
    let (_, again) = samples(&mut client, 3);
    assert!(again[0].time_s > sent[0].time_s);
}

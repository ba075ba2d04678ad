//! Loss and latency of live readings: those that are asked for and those that the controller sends.

use std::time::{Duration, Instant};

use anyhow::{Result, ensure};
use serde_json::json;
use tautline_link::{Controller, Sample};

use super::markdown::table;
use crate::support::ads::symbols::{Style, global};
use crate::support::ads::{Plant, Protocol};

/// A cycle of the controller (s).
const CYCLE_S: f64 = 0.01;
/// Between two looks of the window at what has arrived.
const TICK: Duration = Duration::from_millis(20);

/// A way to get live readings.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Way {
    /// One is asked for after such a pause.
    Asked(Duration),
    /// One is sent in every cycle, and taken after such a pause.
    Sent(Duration),
}

/// What a way delivers.
#[derive(Debug, Clone)]
pub struct Delivered {
    /// Name of the protocol.
    protocol: &'static str,
    way: Way,
    /// Readings per second.
    per_s: f64,
    /// Share of the controller's cycles of which no reading arrived.
    lost: f64,
    /// Ages of the readings when they arrive (s).
    ages_s: Vec<f64>,
}

/// Measures each way for so many seconds, on servers of this machine: one of ours for ADS, that of asyncua for OPC UA.
///
/// # Errors
/// If the connection fails.
pub fn study(seconds: f64) -> Result<Vec<Delivered>> {
    let ways = [
        Way::Asked(TICK),
        Way::Asked(Duration::ZERO),
        Way::Sent(TICK),
        Way::Sent(Duration::from_millis(1)),
    ];
    let mut all = Vec::new();
    for way in ways {
        let plant = Plant::unruly();
        let zero = Instant::now();
        plant.server.run_clock(&global("time"), zero);
        let mut client = plant.client();
        let mut delivered = measure(("ADS", way), seconds, &mut client, zero)?;
        if matches!(way, Way::Sent(_)) {
            // A busy server skips cycles itself, which are not lost on the way.
            let sent = plant.server.cycles_sent();
            delivered.lost = (1.0 - delivered.ages_s.len() as f64 / sent).max(0.0);
        }
        all.push(delivered);
    }
    for way in ways {
        let plant = Plant::speaking(Protocol::OpcUa, Style::Arrays);
        plant
            .server
            .order(json!({"clock": [global("time"), CYCLE_S]}));
        // The clock of the server began within the round trip of the order, some tenths of a millisecond earlier.
        let zero = Instant::now();
        let mut client = plant.client();
        all.push(measure(("OPC UA", way), seconds, &mut client, zero)?);
    }
    Ok(all)
}

fn measure(
    (protocol, way): (&'static str, Way),
    seconds: f64,
    client: &mut dyn Controller,
    zero: Instant,
) -> Result<Delivered> {
    client.connect()?;
    if matches!(way, Way::Sent(_)) {
        client.subscribe(CYCLE_S)?;
    }
    let begun_s = zero.elapsed().as_secs_f64();
    let (mut times_s, mut ages_s) = (Vec::new(), Vec::new());
    while zero.elapsed().as_secs_f64() < begun_s + seconds {
        let arrived: Vec<Sample> = match way {
            Way::Asked(pause) => {
                std::thread::sleep(pause);
                vec![client.sample()?]
            }
            Way::Sent(pause) => {
                std::thread::sleep(pause);
                client.sent()?
            }
        };
        let now_s = zero.elapsed().as_secs_f64();
        times_s.extend(arrived.iter().map(|sample| sample.time_s));
        ages_s.extend(arrived.iter().map(|sample| now_s - sample.time_s));
    }
    ensure!(!times_s.is_empty(), "no reading arrived: {way:?}");
    Ok(Delivered {
        protocol,
        way,
        per_s: times_s.len() as f64 / seconds,
        lost: (1.0 - cycles(&times_s) as f64 / (seconds / CYCLE_S)).max(0.0),
        ages_s,
    })
}

/// Number of cycles in which there is a reading.
fn cycles(times_s: &[f64]) -> usize {
    let mut cycles: Vec<i64> = times_s.iter().map(|t| (t / CYCLE_S) as i64).collect();
    cycles.dedup();
    cycles.len()
}

/// The table of the documentation.
#[must_use]
pub fn markdown(all: &[Delivered]) -> String {
    let ms = |time: Duration| time.as_millis();
    let rows = all.iter().map(|delivered| {
        let way = match delivered.way {
            Way::Asked(Duration::ZERO) => "polled continuously".to_owned(),
            Way::Asked(pause) => format!("polled every {} ms", ms(pause)),
            Way::Sent(pause) => format!("subscribed every 10 ms, fetched every {} ms", ms(pause)),
        };
        let mut ages_s = delivered.ages_s.clone();
        ages_s.sort_by(f64::total_cmp);
        let age = |share: f64| 1e3 * ages_s[(share * (ages_s.len() - 1) as f64).round() as usize];
        format!(
            "{} | {way} | {:.0} | {:.1} % | {:.2} ms | {:.2} ms | {:.2} ms",
            delivered.protocol,
            delivered.per_s,
            100.0 * delivered.lost,
            age(0.5),
            age(0.95),
            age(1.0),
        )
    });
    table(
        "link | readings | per second | cycles of 10 ms without a reading | age on receipt: median | 95 % | maximum",
        rows,
    )
}

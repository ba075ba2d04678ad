//! Time of a sample over ADS on this machine, and how steadily samples come:
//!
//!     cargo bench -p tautline-validation --bench ads [-- --seconds 600]
//!
//! MINI with eight cables behind the server of the tests, so the figures contain a Python process that answers, and the
//! simulated robot beside it; a controller is faster. Needs `bash .ci/python`.

use std::time::{Duration, Instant};

use anyhow::{Context, Result, ensure};
use tautline_link::Controller;
use tautline_validation::support::ads::Plant;
use tautline_validation::support::ads::symbols::Style;

/// Number of samples that are timed.
const SAMPLES: usize = 3000;
/// Rate of the long run.
const PERIOD: Duration = Duration::from_millis(10);
const SECONDS: u64 = 20;

fn main() -> Result<()> {
    let mut arguments = std::env::args().skip_while(|argument| argument != "--seconds");
    let seconds = match arguments.nth(1) {
        Some(text) => text.parse().context("--seconds takes a whole number")?,
        None => SECONDS,
    };
    println!("| sample of 8 cables | mean (ms) | p50 (ms) | p99 (ms) | longest (ms) |");
    println!("|---|---:|---:|---:|---:|");
    for (style, name) in [
        (Style::Arrays, "arrays"),
        (Style::Single, "one symbol per value"),
    ] {
        let plant = Plant::start(style);
        let mut client = plant.client();
        client.connect()?;
        for (mode, kind) in [("reading only", "read"), ("armed", "write")] {
            if kind == "write" {
                client.arm()?;
            }
            let before = plant.server.count(kind);
            print_times(&format!("{name}, {mode}"), &mut client)?;
            let requests = plant.server.count(kind) - before;
            ensure!(requests == SAMPLES as u64, "{requests} requests arrived");
        }
    }
    println!();
    steadily(seconds)
}

fn print_times(name: &str, client: &mut dyn Controller) -> Result<()> {
    let mut times_s = Vec::with_capacity(SAMPLES);
    for _ in 0..SAMPLES {
        let begin = Instant::now();
        client.sample()?;
        times_s.push(begin.elapsed().as_secs_f64());
    }
    times_s.sort_by(f64::total_cmp);
    let mean = times_s.iter().sum::<f64>() / SAMPLES as f64;
    let at = |part: f64| times_s[((SAMPLES - 1) as f64 * part) as usize];
    let [mean, p50, p99, last] = [mean, at(0.5), at(0.99), at(1.0)].map(|time_s| time_s * 1e3);
    println!("| {name} | {mean:.3} | {p50:.3} | {p99:.3} | {last:.3} |");
    Ok(())
}

/// Samples at 100 Hz for a time: one for each period that has begun; a period without one is lost.
fn steadily(seconds: u64) -> Result<()> {
    let plant = Plant::start(Style::Arrays);
    let mut client = plant.client();
    client.connect()?;
    client.arm()?;
    for _ in 0..100 {
        client.sample()?;
    }
    let memory = resident_mib()?;
    let periods = seconds * 1000 / PERIOD.as_millis() as u64;
    let (begin, mut taken, mut lost, mut failed) = (Instant::now(), 0_u64, 0_u64, 0_u64);
    let (mut period, mut longest, mut last) = (0_u64, Duration::ZERO, None::<Instant>);
    while period < periods {
        let due = PERIOD.mul_f64(period as f64);
        std::thread::sleep(due.saturating_sub(begin.elapsed()));
        match client.sample() {
            Ok(_) => taken += 1,
            Err(_) => failed += 1,
        }
        let now = Instant::now();
        longest = longest.max(last.map_or(Duration::ZERO, |last| now - last));
        last = Some(now);
        let current = (begin.elapsed().as_nanos() / PERIOD.as_nanos()) as u64;
        let next = (period + 1).max(current);
        lost += next - (period + 1);
        period = next;
    }
    println!("| 100 Hz, 8 cables, armed | |");
    println!("|---|---:|");
    println!("| time (s) | {:.1} |", begin.elapsed().as_secs_f64());
    println!("| samples | {taken} of {periods} |");
    println!("| periods without a sample | {lost} |");
    println!("| samples that failed | {failed} |");
    println!("| longest gap (ms) | {:.1} |", longest.as_secs_f64() * 1e3);
    println!("| resident memory, start (MiB) | {memory:.1} |");
    println!("| resident memory, end (MiB) | {:.1} |", resident_mib()?);
    Ok(())
}

/// Memory of this process (Linux).
fn resident_mib() -> Result<f64> {
    let status = std::fs::read_to_string("/proc/self/status")?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"));
    let kib = line.and_then(|line| line.split_whitespace().next());
    Ok(kib
        .context("no VmRSS in /proc/self/status")?
        .parse::<f64>()?
        / 1024.0)
}

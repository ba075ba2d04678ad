//! Time and memory of `identify` where poses are very many.

use std::fs;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use anyhow::{Context, Result, ensure};

use super::markdown::table;
use crate::support::process::{PEAK, memory_mib};
use crate::support::program::program;

/// What one number of poses takes.
#[derive(Debug, Clone)]
pub struct Taken {
    poses: usize,
    file_mb: f64,
    seconds: f64,
    /// Most memory at any time (MiB).
    peak_mib: f64,
    /// What the program says: steps and time of the solver, and chi-square.
    says: Vec<String>,
}

/// Simulates so many poses of MINI and identifies from them (Linux).
///
/// # Errors
/// If the program fails.
pub fn identify(poses: usize) -> Result<Taken> {
    let folder = tempfile::tempdir()?;
    let data = folder.path().join("data");
    let path = data
        .to_str()
        .context("the folder has a name that is no text")?;
    let count = poses.to_string();
    let simulate = [
        "simulate", "--robot", "mini", "--poses", &count, "--out", path,
    ];
    let simulated = Command::new(program()).args(simulate).output()?;
    ensure!(simulated.status.success(), "{simulated:?}");
    let begun = Instant::now();
    let mut child = Command::new(program())
        .args(["identify", path])
        .stdout(Stdio::piped())
        .spawn()?;
    let peak_mib = watched(&mut child)?;
    let seconds = begun.elapsed().as_secs_f64();
    let output = child.wait_with_output()?;
    ensure!(output.status.success(), "identify failed");
    let says = String::from_utf8(output.stdout)?;
    Ok(Taken {
        poses,
        file_mb: fs::metadata(data.join("poses.csv"))?.len() as f64 * 1e-6,
        seconds,
        peak_mib,
        says: says.lines().take(2).map(str::to_owned).collect(),
    })
}

/// Waits for the end; the most memory that it had at any time (MiB).
fn watched(child: &mut Child) -> Result<f64> {
    let mut peak_mib = 0.0;
    while child.try_wait()?.is_none() {
        // There is none of a program that has just ended.
        peak_mib = memory_mib(child.id(), PEAK).unwrap_or(peak_mib);
        std::thread::sleep(Duration::from_millis(20));
    }
    Ok(peak_mib)
}

/// The table, and what the program says.
#[must_use]
pub fn markdown(taken: &Taken) -> String {
    let Taken {
        poses,
        file_mb,
        seconds,
        peak_mib,
        says,
    } = taken;
    let row = format!("{poses} | {file_mb:.0} | {seconds:.1} | {peak_mib:.0}");
    let table = table(
        "poses | `poses.csv`, MB | time, s | most memory, MiB",
        [row],
    );
    format!("{table}\n{}\n", says.join("  \n"))
}

//! Time and memory of `identify` where poses are very many.

use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use anyhow::{Context, Result, ensure};

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

/// Waits for the end; the most memory that it had at any time (MiB), which Linux counts.
fn watched(child: &mut Child) -> Result<f64> {
    let status = Path::new("/proc")
        .join(child.id().to_string())
        .join("status");
    let mut peak_kib = 0.0;
    while child.try_wait()?.is_none() {
        let text = fs::read_to_string(&status).unwrap_or_default();
        let peak = text.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        let number = peak.and_then(|rest| rest.split_whitespace().next()?.parse().ok());
        peak_kib = f64::max(peak_kib, number.unwrap_or(0.0));
        std::thread::sleep(Duration::from_millis(20));
    }
    Ok(peak_kib / 1024.0)
}

/// The table, and what the program says.
#[must_use]
pub fn markdown(taken: &Taken) -> String {
    format!(
        "| poses | `poses.csv`, MB | time, s | most memory, MiB |\n|---|---|---|---|\n| {} | {:.0} | {:.1} | {:.0} |\n\n{}\n",
        taken.poses,
        taken.file_mb,
        taken.seconds,
        taken.peak_mib,
        taken.says.join("  \n")
    )
}

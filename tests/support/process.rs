//! What Linux counts of a process: its memory and its processor time.

use std::fs::read_to_string;

use anyhow::{Context, Result};

/// Memory in use.
pub const IN_USE: &str = "VmRSS:";
/// Most memory at any time.
pub const PEAK: &str = "VmHWM:";
/// Ticks of processor time per second, on every Linux of the last decades.
const TICKS_PER_S: f64 = 100.0;

/// Memory of a process (MiB).
///
/// # Errors
/// If there is no such process, or this is not Linux.
pub fn memory_mib(id: u32, which: &str) -> Result<f64> {
    let text = read_to_string(format!("/proc/{id}/status"))?;
    let line = text.lines().find_map(|line| line.strip_prefix(which));
    let kib = line.and_then(|line| line.split_whitespace().next());
    Ok(kib.context(which.to_owned())?.parse::<f64>()? / 1024.0)
}

/// Processor time of a process, with that of threads that have ended (s).
///
/// # Errors
/// If there is no such process, or this is not Linux.
pub fn processor_s(id: u32) -> Result<f64> {
    let text = read_to_string(format!("/proc/{id}/stat"))?;
    // After the name in brackets: state is the third entry, user and system time are the 14th and 15th.
    let (_, rest) = text.rsplit_once(')').context("a name in brackets")?;
    let ticks = rest.split_whitespace().skip(11).take(2).map(str::parse);
    let ticks: Vec<f64> = ticks.collect::<Result<_, _>>()?;
    Ok(ticks.iter().sum::<f64>() / TICKS_PER_S)
}

/// Processor time of a thread in a folder of `/proc` (s).
///
/// # Errors
/// If there is no such thread, or this is not Linux.
pub fn thread_s(folder: &str) -> Result<f64> {
    let text = read_to_string(format!("/proc/{folder}/schedstat"))?;
    let nanoseconds = text.split_whitespace().next().context("a time")?;
    Ok(1e-9 * nanoseconds.parse::<f64>()?)
}

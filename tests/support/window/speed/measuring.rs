//! The window while a simulated robot measures: its frames, and its memory over an hour of the robot's time.

use std::fs;
use std::path::{Path, PathBuf};
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, ensure};
use serde_json::Value;
use tautline_core::geometry::Pose;
use tautline_session::{PlannedPose, Session, Simulator, Timestamp, write_session};

use super::super::Window;
use super::scene::{Scene, frames};
use super::{SIZE, simulated};
use crate::support::process::{IN_USE, memory_mib};
use crate::tables::markdown::table;

/// Poses that are measured before the frames are timed.
const MEASURED: usize = 1000;
/// Poses of the plan; more than an hour has time for.
const PLANNED: usize = 1000;
/// Share of the way from home to a simulated pose at which a planned one is, so that tensions hold it.
const NEAR: f64 = 0.3;
/// Speed of the robot's time in the hour, as a multiple of real time.
const SPEED: &str = "60";
/// Moments at which the memory is read (min of the robot's time).
const MOMENTS: [f64; 7] = [0.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0];
/// Time limit of the hour.
const PATIENCE: Duration = Duration::from_secs(900);

/// The program at a moment of the run.
pub struct Moment {
    /// Time of the robot since the first pose (min).
    pub minutes: f64,
    /// Poses measured so far.
    pub poses: usize,
    /// Resident memory (MiB).
    pub memory_mib: f64,
    /// Size of the recovery files (kB): snapshot, changes and journal.
    pub kept_kb: u64,
}

/// A session with `measured` poses and a plan of more.
fn session(folder: &Path, measured: usize) -> Result<String> {
    let dataset = simulated(measured.max(1) + PLANNED)?;
    let mut session = Session::new(
        "Measuring",
        dataset.robot.clone(),
        Timestamp::from_unix_seconds(1_700_000_000),
    );
    let data = &dataset.measurements;
    let home = dataset.robot.home.context("a home pose")?.pose();
    let planned = |pose: &Pose| Pose {
        position: home.position.lerp(&pose.position, NEAR),
        orientation: home.orientation.slerp(&pose.orientation, NEAR),
    };
    let commanded = data.labels.iter().zip(&data.commanded);
    session.plan = commanded
        .filter_map(|(label, pose)| Some(PlannedPose::new(*label, &planned(pose.as_ref()?))))
        .collect();
    session.simulator = Some(Simulator {
        truth: dataset.robot.clone(),
        seed: 7,
        revealed: true,
    });
    session.measurements = data.select(&(0..measured).collect::<Vec<_>>());
    let name = format!("measuring-{measured}.json");
    write_session(&folder.join(&name), &session)?;
    Ok(name)
}

/// Goes to the phase, connects, arms and starts.
fn begin(window: &mut Window, start: &str) -> Result<()> {
    let phase = window.named("Button", "Phase 3: Measuring")?;
    window.click(&phase)?;
    for name in ["Connect the simulated robot", "Arm", start] {
        let button = window.named("Button", name)?;
        window.rest()?;
        // New elements above it may have moved it.
        let button = window.named("Button", name).unwrap_or(button);
        window.click(&button)?;
    }
    window.named("Button", "Pause")?;
    Ok(())
}

/// The frames while the robot measures, at the speed of a real one.
pub fn scene(folder: &Path) -> Result<Scene> {
    let name = session(folder, MEASURED)?;
    let mut window = Window::open(folder, SIZE, &[&name])?;
    window.named("Canvas", "3D view")?;
    window.command('i')?;
    window.text("Identified from")?;
    window.rest()?;
    begin(&mut window, "Continue measuring")?;
    let (turning, still) = frames(&mut window)?;
    Ok(Scene {
        name: format!("measuring after {MEASURED} poses"),
        turning,
        still,
        idle: None,
        memory_mib: memory_mib(window.id(), IN_USE)?,
    })
}

/// An hour of the robot's time.
pub fn hour(folder: &Path) -> Result<Vec<Moment>> {
    let name = session(folder, 0)?;
    let mut window = Window::open(folder, SIZE, &["--robot-speed", SPEED, &name])?;
    window.named("Canvas", "3D view")?;
    begin(&mut window, "Start measuring")?;
    let kept = kept(folder)?;
    let mut moments: Vec<Moment> = Vec::new();
    let start = Instant::now();
    while moments.len() < MOMENTS.len() {
        ensure!(
            start.elapsed() < PATIENCE,
            "an hour of the robot's time takes too long: {} poses so far",
            moments.last().map_or(0, |moment| moment.poses)
        );
        thread::sleep(Duration::from_millis(100));
        let (_, shown) = window.shown()?;
        let waits = shown.iter().find(|e| e.name.starts_with("Waiting"));
        ensure!(waits.is_none(), "the run waits: {waits:?}");
        let Some((poses, minutes)) = progress(&kept)? else {
            continue;
        };
        if minutes >= MOMENTS[moments.len()] {
            moments.push(Moment {
                minutes,
                poses,
                memory_mib: memory_mib(window.id(), IN_USE)?,
                kept_kb: kept_kb(&kept)?,
            });
        }
    }
    Ok(moments)
}

/// The folder in which the running program keeps its session.
fn kept(folder: &Path) -> Result<PathBuf> {
    let place = folder.join("home").join("recovery");
    let entries = fs::read_dir(&place).context("the recovery folder")?;
    let paths: std::io::Result<Vec<PathBuf>> = entries.map(|entry| Ok(entry?.path())).collect();
    let mut folders = paths?.into_iter().filter(|path| path.is_dir());
    folders.next().context("nothing is kept")
}

/// Number of poses in the journal and the robot's time from the first to the last (min).
fn progress(kept: &Path) -> Result<Option<(usize, f64)>> {
    let text = fs::read_to_string(kept.join("journal.jsonl"))?;
    let whole: Vec<&str> = text
        .split_inclusive('\n')
        .filter(|line| line.ends_with('\n'))
        .collect();
    let (Some(first), Some(last)) = (whole.first(), whole.last()) else {
        return Ok(None);
    };
    let time_s = |line: &str| -> Result<f64> {
        let line: Value = serde_json::from_str(line)?;
        let time = line.pointer("/1/table/columns/time_s/0");
        time.and_then(Value::as_f64).context("a time of the pose")
    };
    Ok(Some((whole.len(), (time_s(last)? - time_s(first)?) / 60.0)))
}

fn kept_kb(kept: &Path) -> Result<u64> {
    let mut bytes = 0;
    for entry in fs::read_dir(kept)? {
        bytes += entry?.metadata()?.len();
    }
    Ok(bytes / 1000)
}

/// The table of the hour.
pub fn markdown(moments: &[Moment]) -> String {
    let rows = moments.iter().map(|moment| {
        format!(
            "{:.0} | {} | {:.1} | {}",
            moment.minutes, moment.poses, moment.memory_mib, moment.kept_kb
        )
    });
    let table = table(
        "robot's time, min | poses measured | memory, MiB | kept for recovery, kB",
        rows,
    );
    format!(
        "An hour of a simulated robot's time, {SPEED} times as fast, the window open at the phase Measuring.\n\n{table}"
    )
}

//! How quick the workbench is: start, opening, turning the robot, standing idle, memory.

use std::fmt::Write as _;
use std::path::Path;
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Context, Result};
use tautline_core::robot::presets;
use tautline_core::simulation::simulate;
use tautline_session::{PhaseData, write_dataset};

use super::{Window, keys};
use crate::truth::preset_options;

const SIZE: [u32; 2] = [1600, 1000];
/// Poses, and so residuals that the adjustment has more than unknowns but for the common ones.
const POSES: [usize; 3] = [25, 1_000, 100_000];
/// Poses of the session whose opening is timed.
const OPENED: usize = 10_000;
const STARTS: usize = 7;
const OPENINGS: usize = 5;
/// How long the robot is turned, how often, and how long nothing is done.
const TURNING: Duration = Duration::from_secs(4);
const TURNS: usize = 3;
const IDLE: Duration = Duration::from_secs(30);
/// Ticks of the processor time in `/proc` per second, under Linux always.
const TICKS_PER_S: f64 = 100.0;

/// What a scene costs.
struct Scene {
    poses: usize,
    /// Time per frame while the robot is turned, the least of some seconds (s).
    turning_s: f64,
    /// Time per frame while the pointer moves over the menus and nothing changes in 3D (s).
    still_s: f64,
    /// Share of one core while nothing happens.
    idle: f64,
    /// Resident memory (MiB).
    memory_mib: f64,
}

/// Measures everything; the program is that of the present profile.
///
/// # Errors
/// If the window cannot be opened or driven.
pub fn measure() -> Result<String> {
    let folder = tempfile::tempdir()?;
    let mut starts = (0..STARTS)
        .map(|_| start(folder.path()))
        .collect::<Result<Vec<f64>>>()?;
    let start_s = median(&mut starts);
    let name = dataset(folder.path(), OPENED)?;
    let mut openings = (0..OPENINGS)
        .map(|_| opening(folder.path(), &name))
        .collect::<Result<Vec<f64>>>()?;
    let opening_s = median(&mut openings);
    let scenes: Result<Vec<Scene>> = POSES
        .iter()
        .map(|poses| scene(folder.path(), *poses))
        .collect();
    Ok(markdown(start_s, opening_s, &scenes?))
}

fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn dataset(folder: &Path, poses: usize) -> Result<String> {
    let preset = presets::find("mini").context("a preset")?;
    let simulated = simulate(&preset.robot, &preset_options(&preset, poses, 5))?;
    let name = format!("poses-{poses}");
    write_dataset(
        &folder.join(&name),
        &simulated.dataset,
        &PhaseData::default(),
    )?;
    Ok(name)
}

/// From the start of the process to the second frame, when the first is on the screen (s).
fn start(folder: &Path) -> Result<f64> {
    let (mut window, begin) = Window::start(folder, SIZE, &[])?;
    window.until("the first frame", |window| {
        Ok((window.shown()?.0 > 1).then_some(()))
    })?;
    Ok(begin.elapsed().as_secs_f64())
}

/// From the command to open to the first frame with the robot, laid out but not painted yet (s).
fn opening(folder: &Path, name: &str) -> Result<f64> {
    let mut window = Window::open(folder, SIZE, &[])?;
    window.enter("Path", name)?;
    let begin = Instant::now();
    window.display.strike(&[], keys::RETURN)?;
    window.named("Canvas", "3D view")?;
    Ok(begin.elapsed().as_secs_f64())
}

fn scene(folder: &Path, poses: usize) -> Result<Scene> {
    let name = dataset(folder, poses)?;
    let mut window = Window::open(folder, SIZE, &[&name])?;
    window.named("Canvas", "3D view")?;
    window.command('i')?;
    window.text("Identified from")?;
    window.rest()?;
    let turned = window.named("Canvas", "3D view")?.middle();
    let menus = (SIZE[0] as i16 / 2, 12);
    let turning = least(&mut window, turned, true)?;
    let still = least(&mut window, menus, false)?;
    window.display.move_to((SIZE[0] as i16 - 4, 4))?;
    thread::sleep(Duration::from_secs(2));
    let before = processor_s(window.id())?;
    thread::sleep(IDLE);
    let idle = (processor_s(window.id())? - before) / IDLE.as_secs_f64();
    Ok(Scene {
        poses,
        turning_s: turning,
        still_s: still,
        idle,
        memory_mib: memory_mib(window.id())?,
    })
}

/// The least of some measurements of the time per frame (s).
fn least(window: &mut Window, place: (i16, i16), pressed: bool) -> Result<f64> {
    let times: Result<Vec<f64>> = (0..TURNS).map(|_| moving(window, place, pressed)).collect();
    Ok(times?.into_iter().fold(f64::INFINITY, f64::min))
}

/// Time per frame while the pointer moves about a place, its button pressed or not (s).
fn moving(window: &mut Window, (x, y): (i16, i16), pressed: bool) -> Result<f64> {
    window.display.move_to((x, y))?;
    if pressed {
        window.display.button(true)?;
    }
    let (before, begin) = (window.shown()?.0, Instant::now());
    let mut step = 0_i16;
    while begin.elapsed() < TURNING {
        step = (step + 1) % 200;
        window.display.move_to((
            x + (step - 100).abs() * 2,
            y + i16::from(pressed) * step / 10,
        ))?;
        thread::sleep(Duration::from_millis(2));
    }
    let seconds = begin.elapsed().as_secs_f64();
    let frames = window.shown()?.0 - before;
    if pressed {
        window.display.button(false)?;
    }
    Ok(seconds / frames.max(1) as f64)
}

/// Processor time that a process has taken (s).
fn processor_s(id: u32) -> Result<f64> {
    let text = std::fs::read_to_string(format!("/proc/{id}/stat"))?;
    // After the name in brackets: state is the third entry, user and system time are the 14th and 15th.
    let (_, rest) = text.rsplit_once(')').context("a name in brackets")?;
    let ticks = rest.split_whitespace().skip(11).take(2).map(str::parse);
    let ticks: Vec<f64> = ticks.collect::<Result<_, _>>()?;
    Ok(ticks.iter().sum::<f64>() / TICKS_PER_S)
}

fn memory_mib(id: u32) -> Result<f64> {
    let text = std::fs::read_to_string(format!("/proc/{id}/status"))?;
    let line = text.lines().find(|line| line.starts_with("VmRSS"));
    let size = line.and_then(|line| line.split_whitespace().nth(1));
    Ok(size.context("VmRSS")?.parse::<f64>()? / 1024.0)
}

fn markdown(start_s: f64, opening_s: f64, scenes: &[Scene]) -> String {
    let load = std::fs::read_to_string("/proc/loadavg").unwrap_or_default();
    let load = load.split_whitespace().next().unwrap_or("unknown");
    let mut text = format!(
        "First frame {start_s:.2} s after the start of the process (median of {STARTS}); {OPENED} poses opened and the frame with the robot laid out \
         {opening_s:.2} s after the command (median of {OPENINGS}). Load of the machine at the end: {load}.\n\n\
         | poses | ms per frame while turning | ms per frame, 3D unchanged | idle, % of a core | memory, MiB |\n|---|---|---|---|---|\n"
    );
    for scene in scenes {
        // Writing to a string does not fail.
        let _ = writeln!(
            text,
            "| {} | {:.1} | {:.1} | {:.2} | {:.0} |",
            scene.poses,
            scene.turning_s * 1e3,
            scene.still_s * 1e3,
            scene.idle * 1e2,
            scene.memory_mib
        );
    }
    text
}

//! Processor time of a still and a moving picture, with and without a task in the background.

use std::fmt::Write as _;
use std::path::Path;
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Context, Result};

use super::super::Window;
use super::{SIZE, dataset, memory_mib};

/// Duration of a turn of the robot, number of turns, and idle time.
const TURNING: Duration = Duration::from_secs(4);
const TURNS: usize = 3;
const IDLE: Duration = Duration::from_secs(30);
/// Ticks of the processor time in `/proc` per second, under Linux always.
const TICKS_PER_S: f64 = 100.0;

/// Costs of a scene.
pub struct Scene {
    /// Name of the scene.
    pub name: String,
    /// While the robot is turned.
    pub turning: Frame,
    /// While the pointer moves over the menus and nothing changes in 3D.
    pub still: Frame,
    /// Share of one core while idle; `None` for scenes without idle time.
    pub idle: Option<f64>,
    /// Resident memory (MiB).
    pub memory_mib: f64,
}

/// Times of a frame, the minimum of several measurements.
#[derive(Clone, Copy)]
pub struct Frame {
    /// Time from one to the next (s).
    pub whole_s: f64,
    /// Processor time of the window's own thread (s); llvmpipe rasterises on others.
    pub own_s: f64,
}

/// Scene with a number of identified poses.
pub fn of_poses(folder: &Path, poses: usize) -> Result<Scene> {
    let name = dataset(folder, poses)?;
    let mut window = Window::open(folder, SIZE, &[&name])?;
    window.named("Canvas", "3D view")?;
    window.command('i')?;
    window.text("Identified from")?;
    window.rest()?;
    let (turning, still) = frames(&mut window)?;
    window.display.move_to((SIZE[0] as i16 - 4, 4))?;
    thread::sleep(Duration::from_secs(2));
    let before = processor_s(window.id())?;
    thread::sleep(IDLE);
    let idle = (processor_s(window.id())? - before) / IDLE.as_secs_f64();
    Ok(Scene {
        name: format!("{poses} poses, {} readings", 9 * poses),
        turning,
        still,
        idle: Some(idle),
        memory_mib: memory_mib(window.id())?,
    })
}

/// Frames while the robot is turned, and while the pointer moves elsewhere.
pub fn frames(window: &mut Window) -> Result<(Frame, Frame)> {
    let turned = window.named("Canvas", "3D view")?.middle();
    let menus = (SIZE[0] as i16 / 2, 12);
    Ok((least(window, turned, true)?, least(window, menus, false)?))
}

/// Minimum of several measurements.
fn least(window: &mut Window, place: (i16, i16), pressed: bool) -> Result<Frame> {
    let mut best = Frame {
        whole_s: f64::INFINITY,
        own_s: f64::INFINITY,
    };
    for _ in 0..TURNS {
        let frame = moving(window, place, pressed)?;
        best.whole_s = best.whole_s.min(frame.whole_s);
        best.own_s = best.own_s.min(frame.own_s);
    }
    Ok(best)
}

/// A frame while the pointer moves about a place, its button pressed or not.
fn moving(window: &mut Window, (x, y): (i16, i16), pressed: bool) -> Result<Frame> {
    window.display.move_to((x, y))?;
    if pressed {
        window.display.button(true)?;
    }
    let (before, begin) = (window.shown()?.0, Instant::now());
    let own_before_s = own_s(window.id())?;
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
    let frames = (window.shown()?.0 - before).max(1) as f64;
    let own_s = own_s(window.id())? - own_before_s;
    if pressed {
        window.display.button(false)?;
    }
    Ok(Frame {
        whole_s: seconds / frames,
        own_s: own_s / frames,
    })
}

/// Processor time that the thread of the window has taken (s).
fn own_s(id: u32) -> Result<f64> {
    let text = std::fs::read_to_string(format!("/proc/{id}/task/{id}/schedstat"))?;
    let nanoseconds = text.split_whitespace().next().context("a time")?;
    Ok(nanoseconds.parse::<f64>()? / 1e9)
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

/// The table of scenes.
pub fn markdown(scenes: &[Scene]) -> String {
    let mut text = "| scene | ms per frame while turning | of these the window's own thread | ms per frame, 3D unchanged | of these the \
                    window's own thread | idle, % of a core | memory, MiB |\n|---|---|---|---|---|---|---|\n"
        .to_owned();
    for scene in scenes {
        let idle = scene.idle.map(|share| format!("{:.2}", share * 1e2));
        // Writing to a string does not fail.
        let _ = writeln!(
            text,
            "| {} | {:.1} | {:.1} | {:.1} | {:.1} | {} | {:.0} |",
            scene.name,
            scene.turning.whole_s * 1e3,
            scene.turning.own_s * 1e3,
            scene.still.whole_s * 1e3,
            scene.still.own_s * 1e3,
            idle.unwrap_or_else(|| "-".to_owned()),
            scene.memory_mib
        );
    }
    text
}

//! Processor time of a still and a moving picture, with and without a task in the background.

use std::path::Path;
use std::thread;
use std::time::{Duration, Instant};

use anyhow::Result;

use super::super::Window;
use super::{SIZE, dataset};
use crate::support::process::{IN_USE, memory_mib, processor_s, thread_s};
use crate::tables::markdown::table;

/// Duration of a turn of the robot, number of turns, and idle time.
const TURNING: Duration = Duration::from_secs(4);
const TURNS: usize = 3;
const IDLE: Duration = Duration::from_secs(30);

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
        memory_mib: memory_mib(window.id(), IN_USE)?,
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
    let own_before_s = thread_s(&format!("{0}/task/{0}", window.id()))?;
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
    let own_s = thread_s(&format!("{0}/task/{0}", window.id()))? - own_before_s;
    if pressed {
        window.display.button(false)?;
    }
    Ok(Frame {
        whole_s: seconds / frames,
        own_s: own_s / frames,
    })
}

/// The table of scenes.
pub fn markdown(scenes: &[Scene]) -> String {
    let rows = scenes.iter().map(|scene| {
        let idle = scene.idle.map(|share| format!("{:.2}", share * 1e2));
        format!(
            "{} | {:.1} | {:.1} | {:.1} | {:.1} | {} | {:.0}",
            scene.name,
            scene.turning.whole_s * 1e3,
            scene.turning.own_s * 1e3,
            scene.still.whole_s * 1e3,
            scene.still.own_s * 1e3,
            idle.as_deref().unwrap_or("-"),
            scene.memory_mib
        )
    });
    table(
        "scene | ms per frame while turning | of these the window's own thread | ms per frame, 3D unchanged | of these the window's own thread | idle, % of a core | memory, MiB",
        rows,
    )
}

//! Speed of the workbench: start, opening, turning the robot, measuring, the record, idling, memory.

mod measuring;
mod record;
mod scene;

use std::path::Path;
use std::time::Instant;

use anyhow::{Context, Result};
use tautline_core::measurement::Dataset;
use tautline_core::robot::presets;
use tautline_core::simulation::simulate;
use tautline_session::{PhaseData, write_dataset};

use super::{Window, keys};
use crate::tables::simulated::preset_options;

const SIZE: [u32; 2] = [1600, 1000];
/// Poses; 11,111 of MINI have 100,000 readings: eight lengths and a distance each.
const POSES: [usize; 4] = [25, 1_000, 11_111, 100_000];
/// Poses of the session whose opening is timed.
const OPENED: usize = 10_000;
const STARTS: usize = 7;
const OPENINGS: usize = 5;

/// Measures everything; the program is that of the present profile.
///
/// # Errors
/// If the window cannot be opened or driven.
pub fn measure() -> Result<String> {
    let folder = tempfile::tempdir()?;
    let folder = folder.path();
    let mut starts = (0..STARTS)
        .map(|_| start(folder))
        .collect::<Result<Vec<f64>>>()?;
    let name = dataset(folder, OPENED)?;
    let mut openings = (0..OPENINGS)
        .map(|_| opening(folder, &name))
        .collect::<Result<Vec<f64>>>()?;
    // A folder each: what an ended program has left behind is read by the next.
    let mut scenes = Vec::new();
    for poses in POSES {
        scenes.push(scene::of_poses(tempfile::tempdir()?.path(), poses)?);
    }
    scenes.push(measuring::scene(tempfile::tempdir()?.path())?);
    scenes.push(record::scene(tempfile::tempdir()?.path())?);
    let hour = measuring::hour(tempfile::tempdir()?.path())?;
    Ok(format!(
        "First frame {:.2} s after the start of the process (median of {STARTS}); {OPENED} poses opened and the frame with the \
         robot laid out {:.2} s after the command (median of {OPENINGS}). Load of the machine at the end: {}.\n\n{}\n{}",
        median(&mut starts),
        median(&mut openings),
        load(),
        scene::markdown(&scenes),
        measuring::markdown(&hour)
    ))
}

/// Measures one part: `hour`, `measuring`, `record`, or a scene with this number of poses.
///
/// # Errors
/// If it is none of these, or the window cannot be opened or driven.
pub fn part(name: &str) -> Result<String> {
    let folder = tempfile::tempdir()?;
    let folder = folder.path();
    Ok(match name {
        "hour" => measuring::markdown(&measuring::hour(folder)?),
        "measuring" => scene::markdown(&[measuring::scene(folder)?]),
        "record" => scene::markdown(&[record::scene(folder)?]),
        poses => {
            let poses = poses
                .parse()
                .context("hour, measuring, record or a number of poses")?;
            scene::markdown(&[scene::of_poses(folder, poses)?])
        }
    })
}

fn load() -> String {
    let load = std::fs::read_to_string("/proc/loadavg").unwrap_or_default();
    let load = load.split_whitespace().next();
    load.unwrap_or("unknown").to_owned()
}

fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn simulated(poses: usize) -> Result<Dataset> {
    let preset = presets::find("mini").context("a preset")?;
    let simulated = simulate(&preset.robot, &preset_options(&preset, poses, 5))?;
    Ok(simulated.dataset)
}

fn dataset(folder: &Path, poses: usize) -> Result<String> {
    let name = format!("poses-{poses}");
    write_dataset(
        &folder.join(&name),
        &simulated(poses)?,
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

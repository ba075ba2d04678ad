//! The window with the record of a robot over many sessions.

use std::path::Path;

use anyhow::{Context, Result};
use tautline_core::robot::presets;
use tautline_core::simulation::{SimulationOptions, TrueGeometry, simulate};
use tautline_session::{Session, Timestamp, write_session};

use super::super::Window;
use super::SIZE;
use super::scene::{Scene, frames};
use crate::support::process::{IN_USE, memory_mib};
use crate::tables::simulated::preset_options;

/// Sessions of the record, and poses of each.
const SESSIONS: u16 = 100;
const POSES: usize = 25;
/// Time from one session to the next (s): a week.
const EVERY_S: i64 = 7 * 86_400;
/// Drift of one pulley from one session to the next (m).
const DRIFT_M: f64 = 1e-4;
/// Folder of the record.
const FOLDER: &str = "record";

/// Sessions of MINI, one of whose pulleys drifts.
fn write(folder: &Path) -> Result<()> {
    let preset = presets::find("mini").context("a preset")?;
    let mut truth = simulate(&preset.robot, &preset_options(&preset, 1, 5))?.truth;
    std::fs::create_dir(folder)?;
    for number in 0..SESSIONS {
        let options = SimulationOptions {
            geometry: TrueGeometry::Nominal,
            ..preset_options(&preset, POSES, u64::from(number) + 1)
        };
        let time = Timestamp::from_unix_seconds(1_600_000_000 + i64::from(number) * EVERY_S);
        let mut session = Session::new(format!("MINI, {number}"), preset.robot.clone(), time);
        session.measurements = simulate(&truth, &options)?.dataset.measurements;
        write_session(&folder.join(format!("{number:03}.json")), &session)?;
        truth.cables[2].pulley.entry_point_m[0] += DRIFT_M;
    }
    Ok(())
}

/// The frames while the pulleys are turned, the path of one of them among them.
pub fn scene(folder: &Path) -> Result<Scene> {
    write(&folder.join(FOLDER))?;
    let mut window = Window::open(folder, SIZE, &[FOLDER])?;
    let course = window.text("Course: Pulley of cable-3")?;
    window.rest()?;
    window.click(&course)?;
    window.text("Path of cable-3")?;
    window.rest()?;
    let (turning, still) = frames(&mut window)?;
    Ok(Scene {
        name: format!("record of {SESSIONS} sessions of MINI"),
        turning,
        still,
        idle: None,
        memory_mib: memory_mib(window.id(), IN_USE)?,
    })
}

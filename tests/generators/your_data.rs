//! The worked examples of docs/YOUR-DATA.md and docs/MY-ROBOT.md: their files, and the output of the commands.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};
use tautline_core::effect::EffectSetting;
use tautline_core::geometry::{Pose, Vec3};
use tautline_core::measurement::{Grid, Measurements};
use tautline_core::robot::{CableMaterial, Robot, presets};
use tautline_core::simulation::{SimulationOptions, simulate};

use tautline_workflow::templates::Template;

use crate::support::console_page;

/// Folder of the example files, beside the page.
const FOLDER: &str = "your-data";
/// Rate of the recording (Hz), and rows at rest and in motion.
const RATE_HZ: f64 = 25.0;
const RESTING: usize = 30;
const MOVING: usize = 10;

/// The pages.
#[must_use]
pub fn pages() -> [PathBuf; 2] {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs");
    ["YOUR-DATA.md", "MY-ROBOT.md"].map(|name| docs.join(name))
}

/// The folder of the example files.
#[must_use]
pub fn folder() -> PathBuf {
    let [page, _] = pages();
    page.with_file_name(FOLDER)
}

/// Name and content of each example file.
///
/// # Errors
/// If the robot cannot be simulated.
pub fn files() -> Result<Vec<(&'static str, String)>> {
    let robot = presets::find("mini").context("no such preset")?.robot;
    let run = |poses, seed| -> Result<Measurements> {
        Ok(simulate(&robot, &SimulationOptions::new(poses, seed))?
            .dataset
            .measurements)
    };
    Ok(vec![
        ("table.csv", table(&run(20, 5)?)),
        ("scope.csv", scope(&run(9, 6)?)),
        ("mistakes.csv", mistakes(&run(20, 7)?)),
        ("points.txt", points(&run(20, 7)?)),
        ("log.csv", log(&run(24, 8)?)),
        ("capture.csv", capture(&run(24, 8)?, 8)?),
        ("pulleys.csv", pulleys(&own_robot())),
        ("winches.csv", winches(&own_robot(), 9)?),
    ])
}

/// A robot with thin wire ropes in a hall, described by a sheet.
fn own_robot() -> Robot {
    let mut robot = Template::Spatial.robot([6.0, 4.0, 3.0]);
    for cable in &mut robot.cables {
        cable.pulley.radius_m = 0.0;
        cable.cable = CableMaterial::default();
        cable.winch.drum_diameter_m = 0.16;
        cable.winch.drum_pitch_m = 0.0;
        cable.winch.length_to_pulley_m = 0.0;
        cable.winch.gear_ratio = 4.0;
    }
    robot
}

/// A sheet with the places of pulleys and platform anchors (mm).
fn pulleys(robot: &Robot) -> String {
    let mut text = "Cable,Pulley x [mm],Pulley y [mm],Pulley z [mm],Platform x [mm],Platform y [mm],Platform z [mm],Drum diameter [mm],Gear ratio\n".to_owned();
    for (index, cable) in robot.cables.iter().enumerate() {
        let _ = write!(text, "cable-{}", index + 1);
        let places = [cable.pulley.entry_point_m, cable.platform_anchor_m];
        for coordinate in places.concat() {
            let _ = write!(text, ",{:.0}", 1e3 * coordinate);
        }
        let drum_mm = 1e3 * cable.winch.drum_diameter_m;
        let _ = writeln!(text, ",{drum_mm:.0},{}", cable.winch.gear_ratio);
    }
    text
}

/// A log of the revolutions at commanded poses (mm, quaternions); the fifth drum winds 0.6 % more than drawn.
fn winches(robot: &Robot, seed: u64) -> Result<String> {
    let hidden = EffectSetting {
        effect: "winch_scale".to_owned(),
        targets: vec![robot.cables[4].name.clone()],
        parameters: [("scale".to_owned(), 0.006)].into(),
    };
    let options = SimulationOptions {
        effects: vec![hidden],
        ..SimulationOptions::new(40, seed)
    };
    let data = simulate(robot, &options)?.dataset.measurements;
    let mut text = "pose".to_owned();
    per_cable(&mut text, ",winch # [rev]");
    text.push_str(",x [mm],y [mm],z [mm],qw,qx,qy,qz\n");
    for row in 0..data.len() {
        let mut line = data.labels[row].to_string();
        cells(&mut line, ",", &data.revolutions, row, 1.0, 5);
        commanded(&mut line, ",", &data, row, 1e3);
        text.push_str(&line);
        text.push('\n');
    }
    Ok(text)
}

/// Excel in German: semicolons, decimal commas, degrees and millimetres.
fn table(data: &Measurements) -> String {
    let mut text = "Punkt".to_owned();
    per_cable(&mut text, ";Winde# Winkel [°]");
    per_cable(&mut text, ";Seilkraft # [N]");
    text.push_str(
        ";Laser [mm];Soll X [mm];Soll Y [mm];Soll Z [mm];Soll qw;Soll qx;Soll qy;Soll qz\n",
    );
    for row in 0..data.len() {
        let mut line = data.labels[row].to_string();
        cells(&mut line, ";", &data.revolutions, row, 360.0, 3);
        cells(&mut line, ";", &data.force_n, row, 1.0, 2);
        let _ = write!(line, ";{:.3}", 1e3 * data.laser_m[row]);
        commanded(&mut line, ";", data, row, 1e3);
        text.push_str(&line.replace('.', ","));
        text.push('\n');
    }
    text
}

/// A recording of TwinCAT Scope: the robot waits at each pose, and moves on.
fn scope(data: &Measurements) -> String {
    let mut names: Vec<String> = (1..=8).map(|k| format!("GVL.Winch{k}.ActPos")).collect();
    names.extend((1..=8).map(|k| format!("GVL.Winch{k}.Force")));
    names.push("GVL.LaserDistance".into());
    let line = |key: &str, value: &dyn Fn(&str) -> String| {
        let cells: Vec<String> = names
            .iter()
            .map(|name| format!("{key}\t{}", value(name)))
            .collect();
        cells.join("\t")
    };
    let mut text = "Name\tCalibration\nFile\tC:\\Scope\\calibration.csv\n\n".to_owned();
    let _ = writeln!(text, "{}", line("Name", &|name| name.into()));
    let _ = writeln!(
        text,
        "{}",
        line("SampleTime[ms]", &|_| format!("{}", 1e3 / RATE_HZ))
    );
    let _ = writeln!(
        text,
        "{}\n",
        line("Unit", &|name| match name.rsplit('.').next() {
            Some("ActPos") => "rev".into(),
            Some("Force") => "N".into(),
            _ => "m".into(),
        })
    );
    let at = |pose: usize| -> Vec<f64> {
        let mut values = [data.revolutions.row(pose), data.force_n.row(pose)].concat();
        values.push(data.laser_m[pose]);
        values
    };
    let mut sample = 0;
    for pose in 0..data.len() {
        let moving = if pose + 1 < data.len() { MOVING } else { 0 };
        for row in 0..RESTING + moving {
            let part = row.saturating_sub(RESTING) as f64 / MOVING as f64;
            let next = at((pose + 1).min(data.len() - 1));
            let values = at(pose)
                .into_iter()
                .zip(next)
                .map(|(from, to)| from + part * (to - from));
            let cells: Vec<String> = values
                .map(|value| format!("{sample}\t{value:.6}"))
                .collect();
            let _ = writeln!(text, "{}", cells.join("\t"));
            sample += 1;
        }
    }
    text.push_str("EOF\n");
    text
}

/// A log whose third winch counts the other way round, and whose fifth and sixth have changed places.
fn mistakes(data: &Measurements) -> String {
    let mut wrong = data.clone();
    for row in 0..data.len() {
        let read = |cable| data.revolutions.get(row, cable);
        wrong.revolutions.set(row, 2, -read(2));
        wrong.revolutions.set(row, 4, read(5));
        wrong.revolutions.set(row, 5, read(4));
    }
    log(&wrong)
}

/// Positions by a laser tracker for some of these poses (mm).
fn points(data: &Measurements) -> String {
    let mut text = String::new();
    for row in (3..data.len()).step_by(4) {
        let position = 1e3 * data.truth.poses[row].position;
        let _ = writeln!(
            text,
            "P{} {:.3} {:.3} {:.3}",
            data.labels[row], position.x, position.y, position.z
        );
    }
    text
}

/// Revolutions, forces, distance and commands.
#[must_use]
pub fn log(data: &Measurements) -> String {
    let mut text = "pose".to_owned();
    per_cable(&mut text, ",rev_#");
    per_cable(&mut text, ",force_#_n");
    text.push_str(",laser_m,x_m,y_m,z_m,qw,qx,qy,qz\n");
    for row in 0..data.len() {
        let mut line = data.labels[row].to_string();
        cells(&mut line, ",", &data.revolutions, row, 1.0, 6);
        cells(&mut line, ",", &data.force_n, row, 1.0, 3);
        let _ = write!(line, ",{:.5}", data.laser_m[row]);
        commanded(&mut line, ",", data, row, 1.0);
        text.push_str(&line);
        text.push('\n');
    }
    text
}

/// Markers on the platform (m, its frame) and on the floor (m, the robot's frame), as a capture names them.
const ON_PLATFORM: [(&str, [f64; 3]); 4] = [
    ("front", [0.12, 0.03, 0.06]),
    ("left", [-0.05, 0.11, 0.05]),
    ("right", [-0.04, -0.12, 0.04]),
    ("top", [0.02, 0.01, 0.15]),
];
const ON_FLOOR: [(&str, [f64; 3]); 1] = [("floor", [0.6, 0.6, -0.5])];
/// Noise of each coordinate of a marker (m).
const MARKER_SD_M: f64 = 2e-4;

/// The robot's frame seen by the cameras of the capture.
#[must_use]
pub fn cameras_see_robot() -> Pose {
    Pose::from_parts([1.9, -0.8, 1.4], [0.8, 0.1, -0.2, 0.55])
}

/// The middle of the markers on the platform (m, its frame).
#[must_use]
pub fn middle_of_markers() -> Vec3 {
    let all = ON_PLATFORM.iter().map(|(_, place)| Vec3::from(*place));
    all.sum::<Vec3>() / ON_PLATFORM.len() as f64
}

/// The markers at these poses as Vicon Nexus exports them (mm), one frame for each pose.
///
/// # Errors
/// If no noise can be drawn.
pub fn capture(data: &Measurements, seed: u64) -> Result<String> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let noise = Normal::new(0.0, MARKER_SD_M)?;
    let markers: Vec<_> = ON_FLOOR.iter().chain(&ON_PLATFORM).collect();
    let mut text = "Trajectories\n100\n,,".to_owned();
    for (name, _) in &markers {
        let _ = write!(text, "cell:{name},,,");
    }
    text.push_str("\nFrame,Sub Frame");
    markers.iter().for_each(|_| text.push_str(",X,Y,Z"));
    text.push_str("\n,");
    markers.iter().for_each(|_| text.push_str(",mm,mm,mm"));
    text.push('\n');
    for (row, pose) in data.truth.poses.iter().enumerate() {
        let _ = write!(text, "{},0", row + 1);
        for (k, (_, place)) in markers.iter().enumerate() {
            let place = Vec3::from(*place);
            let at = if k < ON_FLOOR.len() {
                place
            } else {
                pose.transform(&place)
            };
            for coordinate in cameras_see_robot().transform(&at).iter() {
                let _ = write!(text, ",{:.3}", 1e3 * (coordinate + noise.sample(&mut rng)));
            }
        }
        text.push('\n');
    }
    Ok(text)
}

fn per_cable(header: &mut String, title: &str) {
    (1..=8).for_each(|k| header.push_str(&title.replace('#', &k.to_string())));
}

fn cells(line: &mut String, separator: &str, grid: &Grid, row: usize, factor: f64, digits: usize) {
    for value in grid.row(row) {
        let _ = write!(line, "{separator}{:.digits$}", factor * value);
    }
}

fn commanded(line: &mut String, separator: &str, data: &Measurements, row: usize, factor: f64) {
    match data.commanded[row] {
        Some(pose) => {
            pose.position.iter().for_each(|value| {
                let _ = write!(line, "{separator}{}", factor * (value * 1e6).round() / 1e6);
            });
            pose.orientation_wxyz().iter().for_each(|value| {
                let _ = write!(line, "{separator}{value:.9}");
            });
        }
        None => (0..7).for_each(|_| line.push_str(separator)),
    }
}

/// The page with the present output of its commands.
///
/// # Errors
/// If a command fails.
pub fn with_outputs(page: &str) -> Result<String> {
    let in_folder = |(name, content): (&str, String)| (format!("{FOLDER}/{name}"), content);
    let files: Vec<_> = files()?.into_iter().map(in_folder).collect();
    console_page::with_outputs(page, &files)
}

/// Writes the example files, and the outputs into the pages.
///
/// # Errors
/// If a command fails or a file cannot be written.
pub fn write() -> Result<()> {
    std::fs::create_dir_all(folder())?;
    for (name, content) in files()? {
        tautline_session::write_text(&folder().join(name), &content)?;
    }
    for page in pages() {
        let text = with_outputs(&std::fs::read_to_string(&page)?)?;
        tautline_session::write_text(&page, &text)?;
    }
    Ok(())
}

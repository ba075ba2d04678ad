//! `tautline simulate`.

use std::path::{Path, PathBuf};

use anyhow::Result;
use tautline_core::effect::{BoundEffect, EffectSetting};
use tautline_core::robot::{Robot, presets};
use tautline_core::simulation::{SimulationError, SimulationOptions, TrueGeometry, simulate};
use tautline_session::{PhaseData, read_robot, write_dataset, write_robot};

use super::BadInput;
use crate::output::say;

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// A preset (mini, hall, suspended, planar) or a robot.json
    #[arg(long, value_name = "PRESET|FILE")]
    robot: String,
    /// Number of poses, without the home pose
    #[arg(long, value_name = "N", default_value_t = 25)]
    poses: usize,
    /// Seed of all random numbers
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
    /// Hide an effect in the data; may be repeated
    #[arg(long = "effect", value_name = "ID[:CABLE][:k=v,...]")]
    effects: Vec<String>,
    /// True entry points: measured (of the preset), drawn from the priors, or nominal
    #[arg(long, value_enum)]
    truth: Option<Truth>,
    /// Leave out the noise
    #[arg(long)]
    no_noise: bool,
    /// Folder to write the dataset to
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Truth {
    Measured,
    Drawn,
    Nominal,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    let preset = presets::find(&arguments.robot);
    let robot = match &preset {
        Some(preset) => preset.robot.clone(),
        None => robot_from_file(&arguments.robot)?,
    };
    let measured = preset
        .as_ref()
        .and_then(|p| p.measured_entry_points_m.clone());
    let geometry = match (arguments.truth, measured) {
        (None | Some(Truth::Measured), Some(points)) => TrueGeometry::EntryPoints(points),
        (Some(Truth::Measured), None) => {
            let message = format!("robot \"{}\" has no measured entry points", arguments.robot);
            return Err(BadInput::new(message));
        }
        (Some(Truth::Nominal), _) => TrueGeometry::Nominal,
        _ => TrueGeometry::Drawn,
    };
    let effects: Result<Vec<_>> = arguments
        .effects
        .iter()
        .map(|e| parse_effect(e, &robot))
        .collect();
    let options = SimulationOptions {
        geometry,
        effects: effects?,
        noise: !arguments.no_noise,
        workspace: preset.as_ref().map(|p| p.workspace),
        tension: preset.as_ref().map(|p| p.tension),
        ..SimulationOptions::new(arguments.poses, arguments.seed)
    };
    let run = simulate(&robot, &options).map_err(|error| match error {
        // What an effect names is not there.
        SimulationError::Effect(error) => BadInput::new(format!("--effect: {error}")),
        other => other.into(),
    })?;
    write_dataset(&arguments.out, &run.dataset, &PhaseData::default())?;
    write_robot(&arguments.out.join("truth.json"), &run.truth)?;
    say!(
        "{}: {} poses of {} with {} cables, seed {}; the true robot is in truth.json",
        arguments.out.display(),
        run.dataset.measurements.len(),
        run.dataset.robot.name,
        run.dataset.robot.cable_count(),
        arguments.seed
    );
    if let Some(preset) = preset {
        say!("assumed, not published: {}", preset.assumed);
    }
    Ok(())
}

/// The robot of a file, or what else could be named.
pub fn robot_from_file(name: &str) -> Result<Robot> {
    let path = Path::new(name);
    if !path.exists() {
        let presets = presets::NAMES.join(", ");
        let message = format!("--robot: found \"{name}\", expected a file or one of {presets}");
        return Err(BadInput::new(message));
    }
    Ok(read_robot(path)?.value)
}

/// `ID[:CABLE][:k=v,...]`.
pub fn parse_effect(text: &str, robot: &Robot) -> Result<EffectSetting> {
    let mut parts = text.split(':');
    let mut setting = EffectSetting {
        effect: parts.next().unwrap_or_default().to_owned(),
        targets: Vec::new(),
        parameters: std::collections::BTreeMap::new(),
    };
    for part in parts {
        if !part.contains('=') {
            setting.targets.push(part.to_owned());
            continue;
        }
        for pair in part.split(',') {
            let value = pair
                .split_once('=')
                .and_then(|(k, v)| Some((k, v.parse::<f64>().ok()?)));
            let Some((name, value)) = value.filter(|(_, v)| v.is_finite()) else {
                let message = format!("--effect {text}: found \"{pair}\", expected NAME=NUMBER");
                return Err(BadInput::new(message));
            };
            setting.parameters.insert(name.to_owned(), value);
        }
    }
    let bound = BoundEffect::from_setting(&setting, robot)
        .map_err(|error| BadInput::new(format!("--effect {text}: {error}")))?;
    Ok(bound.setting(robot))
}

//! `tautline plan`.

mod document;
mod report;

use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use tautline_core::effect::{BoundEffect, EffectRequest};
use tautline_core::estimation::Control;
use tautline_core::planning::{Plan, PlanError, PlanOptions, plan};
use tautline_core::robot::{Robot, presets};
use tautline_session::read_robot;

use super::BadInput;
use super::output::{is_readable, write_json};
use crate::output::say;
pub use document::PlanDocument;

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// A preset (mini, hall, suspended, planar) or a robot.json
    #[arg(value_name = "PRESET|FILE")]
    robot: String,
    /// Number of poses, without the home pose
    #[arg(long, value_name = "N", default_value_t = 25)]
    poses: usize,
    /// Number of feasible poses from which to choose
    #[arg(long, value_name = "N", default_value_t = 3000)]
    candidates: usize,
    /// Seed of the poses drawn
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
    /// Effects that are to be estimated as well, as with identify
    #[arg(long, value_name = "ID[:CABLE][:K=V],..", value_delimiter = ',')]
    effects: Vec<String>,
    /// Write the poses in the order of measurement
    #[arg(long, value_name = "FILE.csv")]
    out: Option<PathBuf>,
    /// Write the machine form; - is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    let preset = presets::find(&arguments.robot);
    let robot = match &preset {
        Some(preset) => preset.robot.clone(),
        None => robot_from_file(&arguments.robot)?,
    };
    let effects = bound_effects(arguments, &robot)?;
    let options = PlanOptions {
        candidates: arguments.candidates,
        workspace: preset.as_ref().map(|p| p.workspace),
        tension: preset.as_ref().map(|p| p.tension),
        effects: &effects,
        ..PlanOptions::new(arguments.poses, arguments.seed)
    };
    let planned = plan(&robot, &options, &mut |_| Control::Continue).map_err(|e| match e {
        PlanError::NoPoses => BadInput::new(format!("--poses: {e}")),
        PlanError::Cancelled => e.into(),
        _ => BadInput::new(format!("{}: {e}", arguments.robot)),
    })?;
    if let Some(path) = &arguments.out {
        write_poses(path, &planned)?;
    }
    let document = PlanDocument::of(&robot, &planned);
    if let Some(path) = &arguments.json {
        write_json(path, &tautline_session::document(&document))?;
    }
    if is_readable(arguments.json.as_deref()) {
        report::print(&document);
        if let Some(path) = &arguments.out {
            say!("the poses are in {}", path.display());
        }
    }
    Ok(())
}

fn robot_from_file(name: &str) -> Result<Robot> {
    let path = Path::new(name);
    if !path.exists() {
        let presets = presets::NAMES.join(", ");
        let message = format!("found \"{name}\", expected a file or one of {presets}");
        return Err(BadInput::new(message));
    }
    let read = read_robot(path)?;
    for notice in &read.notices {
        eprintln!("{notice}");
    }
    Ok(read.value)
}

fn bound_effects(arguments: &Arguments, robot: &Robot) -> Result<Vec<BoundEffect>> {
    let mut bound = Vec::new();
    for text in &arguments.effects {
        let request = EffectRequest::parse(text);
        let effects = request.bind(robot);
        bound.extend(effects.map_err(|e| BadInput::new(format!("--effects: {e}")))?);
    }
    Ok(bound)
}

/// `pose,x_m,y_m,z_m,qw,qx,qy,qz`.
fn write_poses(path: &Path, plan: &Plan) -> Result<()> {
    let mut text = "pose,x_m,y_m,z_m,qw,qx,qy,qz\n".to_owned();
    for planned in &plan.poses {
        let position: [f64; 3] = planned.pose.position.into();
        let numbers = position.into_iter().chain(planned.pose.orientation_wxyz());
        text.push_str(&planned.label.to_string());
        numbers.for_each(|number| text.push_str(&format!(",{number}")));
        text.push('\n');
    }
    tautline_session::write_text(path, &text)
        .with_context(|| format!("{} cannot be written", path.display()))
}

//! `tautline precalibrate`.

mod document;
mod fit;
mod model;
mod report;

use std::path::PathBuf;

use anyhow::Result;
use tautline_core::robot::Robot;
use tautline_session::{PhaseData, read_calibration_tables, write_robot};

use super::output::{is_readable, write_json};
use crate::BadInput;
pub use document::Precalibration;

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Dataset folder
    #[arg(value_name = "DATASET")]
    dataset: PathBuf,
    /// Write the machine form; - is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Write the robot with the fitted values
    #[arg(long, value_name = "FILE")]
    model_out: Option<PathBuf>,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    let tables = read_calibration_tables(&arguments.dataset)?;
    let (robot, phases) = tables.value;
    require_any(arguments, &phases)?;
    let fitted = fit::fit(&robot, &phases).map_err(|unfit| {
        let file = arguments.dataset.join(unfit.file);
        BadInput::new(format!("{}: {}", file.display(), unfit.message))
    })?;
    let model = match &arguments.model_out {
        Some(path) => Some((path, model(arguments, robot, &fitted)?)),
        None => None,
    };
    for notice in tables.notices {
        eprintln!("{notice}");
    }
    if let Some((path, (model, left_out))) = model {
        for notice in left_out {
            eprintln!("{notice}");
        }
        write_robot(path, &model)?;
    }
    if let Some(path) = &arguments.json {
        write_json(path, &tautline_session::versioned(&fitted))?;
    }
    if is_readable(arguments.json.as_deref()) {
        report::print(&fitted);
    }
    Ok(())
}

fn require_any(arguments: &Arguments, phases: &PhaseData) -> Result<()> {
    let nothing = phases.winch.is_empty()
        && phases.force.is_empty()
        && phases.home.is_empty()
        && phases.elongation.is_empty();
    if nothing {
        return Err(BadInput::new(format!(
            "{}: found none of winch.csv, force.csv, home.csv and elongation.csv, expected one at least",
            arguments.dataset.display()
        )));
    }
    Ok(())
}

/// The robot with the fitted values and what could not be put into it.
fn model(
    arguments: &Arguments,
    mut robot: Robot,
    fitted: &Precalibration,
) -> Result<(Robot, Vec<String>)> {
    let dataset = arguments.dataset.display();
    let left_out = model::apply(fitted, &mut robot)
        .map_err(|message| BadInput::new(format!("{dataset}/{message}")))?;
    robot.check().map_err(|error| {
        BadInput::new(format!(
            "{dataset}: the fitted values make no possible robot, {error}"
        ))
    })?;
    Ok((robot, left_out))
}

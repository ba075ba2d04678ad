//! `tautline evaluate`.

use std::path::PathBuf;

use anyhow::Result;
use tautline_core::effect::measurements_as_modelled;
use tautline_core::estimation::{Geometry, Poses, Problem};
use tautline_core::measurement::Dataset;
use tautline_session::{read_dataset, read_robot};

use super::BadInput;
use super::fitted::{Fitted, print_report};
use super::output::{is_readable, write_json};

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Dataset folder
    #[arg(value_name = "DATASET")]
    dataset: PathBuf,
    /// Model file or robot.json whose geometry and effects are held
    #[arg(long, value_name = "FILE")]
    model: PathBuf,
    /// Hold the poses, too, at the external instrument's positions
    #[arg(long)]
    poses_held: bool,
    /// Write the machine form; - is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    let folder = read_dataset(&arguments.dataset)?;
    let model = read_robot(&arguments.model)?;
    for notice in folder.notices.iter().chain(&model.notices) {
        eprintln!("{notice}");
    }
    let cables = folder.dataset.robot.cable_count();
    if model.value.cable_count() != cables {
        return Err(BadInput::new(format!(
            "{}: found {} cables, expected the {cables} of the dataset",
            arguments.model.display(),
            model.value.cable_count()
        )));
    }
    let modelled = measurements_as_modelled(&model.value, &folder.dataset.measurements);
    let measurements = modelled.map_err(BadInput::new)?.into_owned();
    let dataset = Dataset {
        robot: model.value,
        measurements,
    };
    let mut problem = Problem::new(&dataset).map_err(BadInput::new)?;
    problem.geometry = Geometry::Held;
    if arguments.poses_held {
        problem.poses = Poses::HeldAtTracker;
    }
    let fitted = Fitted::solve(&problem, 1)?.compared_with(&folder.dataset.robot);
    let identification = fitted.identification();
    if let Some(path) = &arguments.json {
        write_json(path, &tautline_session::document(&identification))?;
    }
    if is_readable(arguments.json.as_deref()) {
        print_report(&fitted, &identification);
    }
    Ok(())
}

//! `tautline evaluate`.

use std::path::PathBuf;

use anyhow::Result;
use tautline_core::estimation::{Control, Poses};
use tautline_core::robot::Robot;
use tautline_workflow::identification::{IdentificationDocument, IdentificationRequest, identify};

use crate::examples::examples;
use crate::failure::Reservation;
use crate::identify::print;
use crate::output::JsonOutput;
use crate::{BadInput, input, standard_input};

#[derive(Debug, clap::Args)]
#[command(after_help = examples(&[
    ("The poses of one run with the pulleys of another", "tautline evaluate bad --model model.json"),
]))]
pub struct Arguments {
    /// Session file or dataset folder; - is a session on standard input
    #[arg(value_name = "SESSION|DATASET")]
    dataset: PathBuf,
    /// Model file or robot.json whose geometry and effects are kept fixed; - is standard input
    #[arg(long, value_name = "FILE")]
    model: PathBuf,
    /// Also keep the poses fixed at the positions measured by the external instrument
    #[arg(long)]
    poses_held: bool,
    #[command(flatten)]
    json: JsonOutput<IdentificationDocument>,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    let measured = input::dataset(&arguments.dataset)?;
    let model: Robot = input::noticed(standard_input::versioned(&arguments.model)?);
    let drawing = measured.robot.clone();
    let poses = match arguments.poses_held {
        true => Poses::HeldAtTracker,
        false => Poses::Estimated,
    };
    let mut request = IdentificationRequest::of_poses(measured, model, poses)
        .map_err(|error| BadInput::new(format!("{}: {error}", arguments.model.display())))?;
    request.lists_readings = false;
    let fitted = identify(&request, &mut |_| Control::Continue).map_err(BadInput::new)?;
    let document = fitted
        .refuse_extrapolation()
        .map_err(BadInput::new)?
        .document();
    arguments
        .json
        .deliver(&document, || print(&document, &drawing))?;
    Reservation::NotConverged.unless(document.converged)
}

//! `tautline precalibrate`.

mod report;

use std::path::PathBuf;

use anyhow::Result;
use tautline_session::{Loaded, read_calibration_tables};
use tautline_workflow::precalibration::{Calibration, Precalibration};

use crate::examples::examples;
use crate::output::{JsonOutput, note, write_model};
use crate::replace::OutputFile;
use crate::{BadInput, input};

#[derive(Debug, clap::Args)]
#[command(after_help = examples(&[
    ("Winches, force sensors, home platform and elongation", "tautline precalibrate phases"),
    ("And the robot with the fitted values", "tautline precalibrate phases --model-out phases-robot.json"),
]))]
pub struct Arguments {
    /// Session file or dataset folder; - is a session on standard input
    #[arg(value_name = "SESSION|DATASET")]
    dataset: PathBuf,
    #[command(flatten)]
    json: JsonOutput<Precalibration>,
    /// Write the robot with the fitted values as a model file; - is standard output
    #[arg(long, value_name = "FILE")]
    model_out: Option<OutputFile>,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    let tables = match arguments.dataset.is_dir() {
        true => read_calibration_tables(&arguments.dataset)?,
        false => {
            let session = input::session(&arguments.dataset)?;
            Loaded {
                value: (session.robot, session.phases),
                notices: Vec::new(),
            }
        }
    };
    let (robot, phases) = &tables.value;
    let fits = Calibration::new(robot, phases);
    let document = Precalibration::of(robot, phases, &fits);
    let document =
        document.map_err(|failure| BadInput::new(failure.sentence(&arguments.dataset)))?;
    let proposal = fits.with_all();
    for notice in &tables.notices {
        note!("{notice}");
    }
    if let Some(path) = &arguments.model_out {
        let model = proposal
            .robot
            .map_err(|error| BadInput::new(format!("{}: {error}", arguments.dataset.display())))?;
        for notice in &proposal.left_out {
            note!("{notice}");
        }
        write_model(path, &model)?;
    }
    arguments
        .json
        .deliver(&document, || report::print(&document))
}

//! `tautline history`.

mod report;

use std::path::PathBuf;

use anyhow::Result;
use tautline_workflow::clock;
use tautline_workflow::history::{HistoryDocument, RobotRecord, TOLERANCE_M};

use crate::BadInput;
use crate::examples::examples;
use crate::output::{JsonOutput, note};

#[derive(Debug, clap::Args)]
#[command(after_help = examples(&[
    ("What moved since January, and when to calibrate again", "tautline history mini-2026"),
    ("The same for a tolerance of 2 mm, as JSON", "tautline history mini-2026 --tolerance 2 --json -"),
]))]
pub struct Arguments {
    /// Folder with the sessions and dataset folders of one robot
    folder: PathBuf,
    /// Largest tolerable displacement of a pulley (mm)
    #[arg(long, value_name = "MM", default_value_t = 1e3 * TOLERANCE_M)]
    tolerance: f64,
    #[command(flatten)]
    json: JsonOutput,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    if !(arguments.tolerance > 0.0 && arguments.tolerance.is_finite()) {
        return Err(BadInput::new(format!(
            "--tolerance: found {}, expected a positive number of millimetres",
            arguments.tolerance
        )));
    }
    let folder = &arguments.folder;
    let record = RobotRecord::open(folder, clock::now())
        .map_err(|error| BadInput::new(error.to_string()))?;
    for notice in &record.notices {
        note!("{notice}");
    }
    let found = record
        .history(folder, 1e-3 * arguments.tolerance)
        .map_err(|error| BadInput::new(error.to_string()))?;
    let document = HistoryDocument::of(&record, &found);
    arguments
        .json
        .deliver(&document, || report::print(&record, &found))
}

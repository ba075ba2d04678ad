//! `tautline history`.

mod report;

use std::path::PathBuf;

use anyhow::Result;
use tautline_core::estimation::Control;
use tautline_workflow::clock;
use tautline_workflow::history::{
    HistoryDocument, RobotRecord, TOLERANCE_M, Tolerance, pulleys_csv,
};
use tautline_workflow::report::{HistoryInput, ReportChoice, render_history};

use crate::BadInput;
use crate::examples::examples;
use crate::output::{JsonOutput, note, write_file};
use crate::position_tolerance::{PositionTolerance, metres};
use crate::replace::OutputFile;
use crate::report_format::report_format;

#[derive(Debug, clap::Args)]
#[command(after_help = examples(&[
    ("What moved since January, and when to calibrate again", "tautline history mini-2026"),
    ("The same as a report with the course of every pulley", "tautline history mini-2026 --report year.html"),
    ("The same for a tolerance of 2 mm, as JSON", "tautline history mini-2026 --tolerance 2 --json -"),
    ("Until when the platform is accurate to 1 mm", "tautline history mini-2026 --tolerance-position 1"),
]))]
pub struct Arguments {
    /// Folder with the sessions and dataset folders of one robot
    folder: PathBuf,
    /// Largest tolerable displacement of a pulley (mm), for the date of the next calibration
    #[arg(
        long,
        value_name = "MM",
        default_value_t = 1e3 * TOLERANCE_M,
        conflicts_with = "tolerance_position"
    )]
    tolerance: f64,
    #[command(flatten)]
    position: PositionTolerance,
    #[command(flatten)]
    json: JsonOutput<HistoryDocument>,
    /// Write a report of the record; its name must end with .html or .pdf; - is HTML on standard output
    #[arg(long, value_name = "FILE")]
    report: Option<OutputFile>,
    /// Write the pulleys of all sessions with all sessions taken into account, one row each; - is standard output
    #[arg(long, value_name = "FILE.csv")]
    csv: Option<OutputFile>,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    let tolerance = match arguments.position.given()? {
        Some(of_position) => of_position,
        None => Tolerance::Pulley(metres("--tolerance", arguments.tolerance)?),
    };
    let (report, csv) = (arguments.report.as_deref(), arguments.csv.as_deref());
    let format = report.map(|path| report_format("--report", path));
    let format = format.transpose()?;
    let folder = &arguments.folder;
    let record = RobotRecord::open(folder, clock::now(), &mut |_, _| Control::Continue)
        .map_err(|error| BadInput::new(error.to_string()))?;
    for notice in &record.notices {
        note!("{notice}");
    }
    let found = record
        .history(folder, tolerance)
        .map_err(|error| BadInput::new(error.to_string()))?;
    if let Some((path, format)) = report.zip(format) {
        let input = HistoryInput {
            record: &record,
            found: &found,
            choice: &ReportChoice::default(),
            now: clock::now(),
        };
        write_file(path, &render_history(&input, format)?)?;
    }
    if let Some(path) = csv {
        write_file(path, pulleys_csv(&record, &found).as_bytes())?;
    }
    let document = HistoryDocument::of(&record, &found);
    arguments
        .json
        .deliver(&document, || report::print(&record, &found))
}

//! `tautline compare`.

mod report;

use std::path::{Path, PathBuf};

use crate::BadInput;
use anyhow::Result;
use tautline_core::estimation::Control;
use tautline_session::{Method, Session};
use tautline_workflow::clock;
use tautline_workflow::comparison::{
    ComparisonDocument, LEVEL, compare_identifications, identify_to_compare,
};
use tautline_workflow::identification::Identification;
use tautline_workflow::report::{ComparisonInput, ReportChoice, render_comparison};

use crate::examples::examples;
use crate::input;
use crate::output::{JsonOutput, note, write_file};
use crate::replace::OutputFile;
use crate::report_format::report_format;

#[derive(Debug, clap::Args)]
#[command(after_help = examples(&[
    ("Which pulleys differ between two datasets or sessions", "tautline compare mini bad"),
    ("The same as a report", "tautline compare mini bad --report moved.html"),
]))]
pub struct Arguments {
    /// Session file or dataset folder of the first run; - is a session on standard input
    #[arg(value_name = "SESSION_A")]
    first: PathBuf,
    /// Session file or dataset folder of the second run
    #[arg(value_name = "SESSION_B")]
    second: PathBuf,
    /// Significance level: probability of finding a difference between two runs of an unchanged robot
    #[arg(long, value_name = "PROBABILITY", default_value_t = LEVEL)]
    level: f64,
    #[command(flatten)]
    json: JsonOutput<ComparisonDocument>,
    /// Write a report of the comparison; its name must end with .html or .pdf; - is HTML on standard output
    #[arg(long, value_name = "FILE")]
    report: Option<OutputFile>,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    let level = arguments.level;
    if !(level > 0.0 && level < 1.0) {
        return Err(BadInput::new(format!(
            "--level: found {level}, expected a probability between 0 and 1"
        )));
    }
    let report = arguments.report.as_deref();
    let format = report.map(|path| report_format("--report", path));
    let format = format.transpose()?;
    let (session_a, first) = identified(&arguments.first)?;
    let (session_b, second) = identified(&arguments.second)?;
    let sessions = [session_a, session_b];
    let compared = compare_identifications([&first, &second], level).map_err(BadInput::new)?;
    if let (Some(path), Some(format)) = (report, format) {
        let input = ComparisonInput {
            names: sessions.each_ref().map(|session| session.name.as_str()),
            fits: [&first, &second],
            is_simulated: sessions.iter().any(Session::is_simulated),
            comparison: &compared,
            choice: &ReportChoice::default(),
            now: clock::now(),
        };
        write_file(path, &render_comparison(&input, format)?)?;
    }
    let document = ComparisonDocument::of(&compared);
    arguments
        .json
        .deliver(&document, || report::print(&compared, &document))
}

/// A session and its identification.
fn identified(path: &Path) -> Result<(Session, Identification)> {
    let session = input::session(path)?;
    if session.settings.identification.method == Method::Published {
        note!(
            "{}: the published method has no standard deviations to compare with; the joint one is used",
            path.display()
        );
    }
    let found = identify_to_compare(&session, &mut |_| Control::Continue)
        .map_err(|error| BadInput::new(format!("{}: {error}", path.display())))?;
    Ok((session, found))
}

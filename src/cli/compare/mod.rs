//! `tautline compare`.

mod document;
mod report;

use std::path::{Path, PathBuf};

use crate::BadInput;
use anyhow::Result;
use tautline_core::estimation::Control;
use tautline_session::Method;
use tautline_workflow::comparison::{LEVEL, compare_identifications, identify_to_compare};
use tautline_workflow::identification::Identification;

use crate::input;
use crate::output::{JsonOutput, note};
pub use document::ComparisonDocument;

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Session file or dataset folder of the first run
    #[arg(value_name = "SESSION_A")]
    first: PathBuf,
    /// Session file or dataset folder of the second run
    #[arg(value_name = "SESSION_B")]
    second: PathBuf,
    /// Probability of calling two runs of the same robot different
    #[arg(long, value_name = "P", default_value_t = LEVEL)]
    level: f64,
    #[command(flatten)]
    json: JsonOutput,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    let level = arguments.level;
    if !(level > 0.0 && level < 1.0) {
        return Err(BadInput::new(format!(
            "--level: found {level}, expected a probability between 0 and 1"
        )));
    }
    let (first, second) = (
        identified(&arguments.first)?,
        identified(&arguments.second)?,
    );
    let compared = compare_identifications([&first, &second], level).map_err(BadInput::new)?;
    let document = ComparisonDocument::of(&compared);
    arguments
        .json
        .deliver(&document, || report::print(&compared, &document))
}

fn identified(path: &Path) -> Result<Identification> {
    let session = input::session(path)?;
    if session.settings.identification.method == Method::Published {
        note!(
            "{}: the published method has no standard deviations to compare with; the joint one is used",
            path.display()
        );
    }
    identify_to_compare(&session, &mut |_| Control::Continue)
        .map_err(|error| BadInput::new(format!("{}: {error}", path.display())))
}

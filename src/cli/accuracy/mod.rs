//! `tautline accuracy`.

mod report;

use std::path::PathBuf;

use anyhow::Result;

use crate::examples::examples;
use crate::output::{JsonOutput, note};
use crate::{BadInput, standard_input};
pub use report::print;
use tautline_workflow::accuracy::{Accuracy, accuracy, group, is_partly_oriented, word};

#[derive(Debug, clap::Args)]
#[command(after_help = examples(&[
    ("Figures of the poses that simulate or verify wrote", "tautline accuracy phases/check.csv"),
    ("The same from a pipe, for another program", "tautline accuracy - --json - < phases/check.csv"),
]))]
pub struct Arguments {
    /// The check.csv; - is standard input
    #[arg(value_name = "CHECK.csv")]
    check: PathBuf,
    #[command(flatten)]
    json: JsonOutput<Accuracy>,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    let rows = standard_input::check_rows(&arguments.check)?;
    let file = arguments.check.display();
    let at_file = |error: String| BadInput::new(format!("{file}: {error}"));
    let groups = group(&rows.value).map_err(at_file)?;
    let accuracy = accuracy(&groups).map_err(at_file)?;
    for notice in &rows.notices {
        note!("{notice}");
    }
    for group in groups.iter().filter(|g| is_partly_oriented(g)) {
        let kind = word(group.kind);
        note!(
            "{file}: {kind} \"{}\" has rows without orientation, so it gets no orientation figures",
            group.name
        );
    }
    arguments.json.deliver(&accuracy, || print(&accuracy))
}

//! `tautline accuracy`.

use std::path::PathBuf;

use anyhow::Result;

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// The check.csv
    #[arg(value_name = "CHECK.csv")]
    check: PathBuf,
    /// Write the machine form; - is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    let _ = (&arguments.check, &arguments.json);
    Ok(())
}

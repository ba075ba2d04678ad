//! `tautline precalibrate`.

use std::path::PathBuf;

use anyhow::Result;

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Dataset folder
    #[arg(value_name = "DATASET")]
    dataset: PathBuf,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    let _ = &arguments.dataset;
    Ok(())
}

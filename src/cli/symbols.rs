//! `tautline symbols`.

use std::path::PathBuf;

use anyhow::Result;
use tautline_session::AdsMapping;

use crate::input;
use crate::output::write_json;

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// A preset (mini, hall, suspended, planar) or a robot.json
    #[arg(value_name = "PRESET|FILE")]
    robot: String,
    /// File to write; - is standard output
    #[arg(long, value_name = "FILE", default_value = "-")]
    out: PathBuf,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    let mapping = AdsMapping::default_for(&input::robot(&arguments.robot)?.robot);
    write_json(&arguments.out, &tautline_session::versioned(&mapping))
}

//! `tautline symbols`.

use std::path::PathBuf;

use anyhow::Result;
use tautline_session::SymbolMapping;

use crate::input;
use crate::output::write_json;

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// A preset (mini, hall, suspended, planar) or a robot.json
    #[arg(value_name = "PRESET|FILE")]
    robot: String,
    /// Write the nodes of an OPC UA controller instead of the symbols of an ADS controller
    #[arg(long)]
    opcua: bool,
    /// File to write; - is standard output
    #[arg(long, value_name = "FILE", default_value = "-")]
    out: PathBuf,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    let robot = input::robot(&arguments.robot)?.robot;
    let mapping = match arguments.opcua {
        true => SymbolMapping::default_nodes_for(&robot),
        false => SymbolMapping::default_for(&robot),
    };
    write_json(&arguments.out, &tautline_session::versioned(&mapping))
}

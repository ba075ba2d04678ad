//! `tautline symbols`.

use anyhow::Result;
use tautline_session::SymbolMapping;

use crate::examples::examples;
use crate::input;
use crate::output::write_json;
use crate::replace::OutputFile;

#[derive(Debug, clap::Args)]
#[command(after_help = examples(&[
    ("For a controller over ADS", "tautline symbols mini -o symbols.json"),
    ("For an OPC UA server, on standard output", "tautline symbols mini --opcua"),
]))]
pub struct Arguments {
    #[arg(value_name = "NAME|FILE", help = input::robot_help("Robot"))]
    robot: String,
    /// Write the nodes of an OPC UA controller instead of the symbols of an ADS controller
    #[arg(long)]
    opcua: bool,
    /// File to write; - is standard output
    #[arg(short, long, value_name = "FILE", default_value = "-")]
    out: OutputFile,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    let robot = input::robot(&arguments.robot)?.robot;
    let mapping = match arguments.opcua {
        true => SymbolMapping::default_nodes_for(&robot),
        false => SymbolMapping::default_for(&robot),
    };
    write_json(&arguments.out, &tautline_session::versioned(&mapping))
}

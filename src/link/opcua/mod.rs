//! Controllers over OPC UA.
//!
//! Symbols are nodes, named by their identifiers; everything else is as with ADS, see [`crate::symbols`]. There is no thread, no
//! subscription and no encryption: values are read and written by requests, each of which ends, answered or not, after
//! at most [`OpcUaOptions::timeout_s`]. The messages are encoded and decoded by `async-opcua-types`; their transport is
//! implemented here, because the client of that project buffers as many bytes as a server announces, reconnects on its own, and
//! needs a runtime with threads.

mod address;
mod client;
mod options;
mod program;
#[cfg(test)]
mod tests;
mod values;
mod wire;

use std::sync::Arc;

use tautline_core::robot::Robot;
use tautline_session::SymbolMapping;

pub use address::OpcUaAddress;
pub use options::OpcUaOptions;

use crate::clock::Clock;
use crate::error::LinkError;
use crate::symbols::{self as found, SymbolCheck, SymbolController};
use program::OpcUaServer;

/// Creates a controller that is not connected. The clock detects missing acknowledgements.
///
/// # Errors
/// If the mapping does not fit the robot, or names an unknown parameter.
pub fn controller(
    address: OpcUaAddress,
    mapping: &SymbolMapping,
    robot: &Robot,
    options: OpcUaOptions,
    clock: Arc<dyn Clock>,
) -> Result<SymbolController, LinkError> {
    let server = Box::new(OpcUaServer { address, options });
    SymbolController::new(server, (mapping, robot), options.acknowledge_s, clock)
}

/// Connects, looks up every node of a mapping, and disconnects. Nothing is armed and nothing is written.
///
/// # Errors
/// If the mapping does not fit the robot, or the connection fails.
pub fn check_symbols(
    address: OpcUaAddress,
    mapping: &SymbolMapping,
    robot: &Robot,
    options: OpcUaOptions,
) -> Result<Vec<SymbolCheck>, LinkError> {
    found::check(&OpcUaServer { address, options }, mapping, robot)
}

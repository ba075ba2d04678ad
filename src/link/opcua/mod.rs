//! Controllers that speak OPC UA.
//!
//! Symbols are nodes, named by their identifiers; all else is as with ADS, see [`crate::symbols`]. There is no thread, no
//! subscription and no encryption: values are read and written by requests, each of which is over, answered or not, after
//! at most [`OpcUaOptions::timeout_s`]. The messages are encoded and decoded by `async-opcua-types`; their transport is
//! ours, because the client of that project buffers as many bytes as a server announces, connects again by itself, and
//! needs a runtime with threads of its own.

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

/// A controller that is not connected. The clock tells a late acknowledgement.
///
/// # Errors
/// If the mapping does not fit the robot or names a parameter that it does not have.
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

/// Connects, looks up every node of a mapping and closes the connection. Nothing is armed and nothing is written.
///
/// # Errors
/// If the mapping does not fit the robot, or the controller cannot be connected.
pub fn check_symbols(
    address: OpcUaAddress,
    mapping: &SymbolMapping,
    robot: &Robot,
    options: OpcUaOptions,
) -> Result<Vec<SymbolCheck>, LinkError> {
    found::check(&OpcUaServer { address, options }, mapping, robot)
}

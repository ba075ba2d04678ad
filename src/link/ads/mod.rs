//! Controllers over ADS, Beckhoff's protocol.
//!
//! A [`tautline_session::SymbolMapping`] states which symbol holds which quantity; `docs/ADS.md` describes the handshake with
//! the controller's program. Requests are sent only by calls of the caller, and each ends, answered or not,
//! after at most [`AdsOptions::timeout_s`]. There is no thread: whoever sends a request reads the response. Nothing is written
//! before [`crate::Controller::arm`].
//!
//! Readings on which decisions depend are polled: one request returns all readings of one instant, and the response proves that
//! the connection works. Notifications, which the controller sends in every cycle, are for display only.

mod address;
mod client;
mod codes;
mod notifications;
mod options;
mod program;
mod symbols;
mod wire;

use std::sync::Arc;

use tautline_core::robot::Robot;
use tautline_session::SymbolMapping;

pub use address::AdsAddress;
pub use options::AdsOptions;

use crate::clock::Clock;
use crate::error::LinkError;
use crate::symbols::{self as found, SymbolCheck, SymbolController};
use program::AdsServer;

/// Creates a controller that is not connected. The clock detects missing acknowledgements.
///
/// # Errors
/// If the mapping does not fit the robot, or names an unknown parameter.
pub fn controller(
    address: AdsAddress,
    mapping: &SymbolMapping,
    robot: &Robot,
    options: AdsOptions,
    clock: Arc<dyn Clock>,
) -> Result<SymbolController, LinkError> {
    let server = Box::new(AdsServer { address, options });
    SymbolController::new(server, (mapping, robot), options.acknowledge_s, clock)
}

/// Connects, looks up every symbol of a mapping, and disconnects. Nothing is armed and nothing is written.
///
/// # Errors
/// If the mapping does not fit the robot, the connection fails, or the controller's program does not run.
pub fn check_symbols(
    address: AdsAddress,
    mapping: &SymbolMapping,
    robot: &Robot,
    options: AdsOptions,
) -> Result<Vec<SymbolCheck>, LinkError> {
    found::check(&AdsServer { address, options }, mapping, robot)
}

//! Controllers that speak ADS, Beckhoff's protocol.
//!
//! A [`tautline_session::SymbolMapping`] says which symbol holds what; `docs/ADS.md` describes the handshake between this
//! program and that of the controller. Requests are sent only by calls from outside, and each is over, answered or not,
//! after at most [`AdsOptions::timeout_s`]. There is no thread: an answer is read by whoever asked. Nothing is written
//! before [`crate::Controller::arm`].
//!
//! Whatever decides is polled: one request returns all readings of one moment, and an answer proves that the controller is
//! there. Notifications, which the controller sends in every cycle, are for display only.

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

/// A controller that is not connected. The clock tells a late acknowledgement.
///
/// # Errors
/// If the mapping does not fit the robot or names a parameter that it does not have.
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

/// Connects, looks up every symbol of a mapping and closes the connection. Nothing is armed and nothing is written.
///
/// # Errors
/// If the mapping does not fit the robot, the controller cannot be connected or its program does not run.
pub fn check_symbols(
    address: AdsAddress,
    mapping: &SymbolMapping,
    robot: &Robot,
    options: AdsOptions,
) -> Result<Vec<SymbolCheck>, LinkError> {
    found::check(&AdsServer { address, options }, mapping, robot)
}

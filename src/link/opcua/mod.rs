//! Controllers over OPC UA.
//!
//! Symbols are nodes, named by their identifiers; everything else is as with ADS, see [`crate::symbols`]. There is no thread:
//! values are read and written by requests, each of which ends, answered or not, after at most
//! [`OpcUaOptions::timeout_s`]; live values are sent by the server and taken when they are wanted. The messages are encoded and decoded by `async-opcua-types`, the cryptography is that of
//! `async-opcua-crypto`; their transport is implemented here, because the client of that project buffers as many bytes as a
//! server announces, reconnects on its own, and needs a runtime with threads, and because its channel (`async-opcua-core`) takes
//! an unprotected answer, or one under any certificate, for an answer of the server, and panics where a message is too short.

mod address;
mod certificate;
mod client;
mod credentials;
mod endpoints;
mod identity;
mod opening;
mod options;
mod passwords;
mod program;
mod protection;
mod subscription;
#[cfg(test)]
mod testing;
#[cfg(test)]
mod tests;
mod user;
mod values;
mod wire;

use std::sync::Arc;

use tautline_core::robot::Robot;
use tautline_session::SymbolMapping;

pub use address::OpcUaAddress;
pub use credentials::{Credentials, KeyStore, Password};
pub use identity::ClientIdentity;
pub use options::OpcUaOptions;
pub use passwords::{Account, DesktopKeyring, HAS_KEYRING, PasswordStore, PasswordStoreError};

use crate::clock::Clock;
use crate::error::LinkError;
use crate::symbols::{self as found, SymbolCheck, SymbolController};

/// A server to connect to.
#[derive(Debug, Clone)]
pub struct OpcUaServer {
    /// Its address.
    pub address: OpcUaAddress,
    /// Timeouts.
    pub options: OpcUaOptions,
    /// Credentials of the client.
    pub credentials: Credentials,
}

/// Creates a controller that is not connected. The clock detects missing acknowledgements.
///
/// # Errors
/// If the mapping does not fit the robot, or names an unknown parameter.
pub fn controller(
    server: OpcUaServer,
    mapping: &SymbolMapping,
    robot: &Robot,
    clock: Arc<dyn Clock>,
) -> Result<SymbolController, LinkError> {
    let acknowledge_s = server.options.acknowledge_s;
    SymbolController::new(Box::new(server), (mapping, robot), acknowledge_s, clock)
}

/// Connects, looks up every node of a mapping, and disconnects. Nothing is armed and nothing is written.
///
/// # Errors
/// If the mapping does not fit the robot, or the connection fails.
pub fn check_symbols(
    server: &OpcUaServer,
    mapping: &SymbolMapping,
    robot: &Robot,
) -> Result<Vec<SymbolCheck>, LinkError> {
    found::check(server, mapping, robot)
}

//! Checks the symbols of a controller.

use tautline_core::robot::Robot;
use tautline_link::opcua::{Credentials, OpcUaServer};
use tautline_link::symbols::SymbolCheck;
use tautline_link::{LinkError, ads, opcua};
use tautline_session::Connection;

use super::choice::ControllerChoice;
use super::setup::{ads_parts, opcua_parts};

/// Connects to the controller of the settings, looks up every symbol, and closes the connection; nothing is written.
///
/// # Errors
/// If the controller has no symbols, the symbols do not fit the robot, or the connection fails.
pub fn check_symbols(
    connection: &Connection,
    robot: &Robot,
    credentials: Credentials,
) -> Result<Vec<SymbolCheck>, LinkError> {
    match ControllerChoice::of_connection(connection) {
        ControllerChoice::Ads(address) => {
            let (mapping, options) = ads_parts(connection, robot);
            ads::check_symbols(address, &mapping, robot, options)
        }
        ControllerChoice::OpcUa(address) => {
            let (server, mapping) = opcua_parts(&address, connection, robot);
            let server = OpcUaServer {
                credentials,
                ..server
            };
            opcua::check_symbols(&server, &mapping, robot)
        }
        choice => Err(LinkError::Setup(format!("{choice} has no symbols"))),
    }
}

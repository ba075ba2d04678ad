//! Which symbols of a mapping a controller has.

use std::sync::Arc;

use tautline_core::robot::Robot;
use tautline_session::AdsMapping;

use super::address::AdsAddress;
use super::layout::Layout;
use super::live::look_up;
use super::options::AdsOptions;
use crate::clock::Clock;
use crate::controller::LinkError;

/// A symbol of a mapping at the controller.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SymbolCheck {
    /// Its name, that of one cable where there is one for each.
    pub name: String,
    /// What the controller says of it.
    pub found: SymbolFound,
}

/// What a controller says of a symbol.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum SymbolFound {
    /// It is there and can be used.
    Good {
        /// Its type as the controller calls it.
        type_name: String,
        /// All its bytes.
        bytes: usize,
    },
    /// There is no such symbol; what the controller answers.
    Missing(String),
    /// It is there and cannot be used.
    Wrong {
        /// Its type as the controller calls it.
        type_name: String,
        /// All its bytes.
        bytes: usize,
        /// What was found and expected.
        why: String,
    },
}

/// Connects, looks every symbol of a mapping up and ends the connection. Nothing is armed and nothing is written.
///
/// # Errors
/// If the mapping does not fit the robot, there is no connection to be had or the program does not run.
pub fn check_symbols(
    address: &AdsAddress,
    mapping: &AdsMapping,
    robot: &Robot,
    options: &AdsOptions,
    clock: Arc<dyn Clock>,
) -> Result<Vec<SymbolCheck>, LinkError> {
    let layout = Layout::of(mapping, robot)?;
    look_up(address, &layout, options, clock)
}

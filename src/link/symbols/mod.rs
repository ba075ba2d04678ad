//! Controllers whose readings, commands and parameters are named symbols, independent of the protocol.
//!
//! A [`tautline_session::SymbolMapping`] states which symbol holds which quantity; `docs/ADS.md` describes the handshake with
//! the controller's program. A protocol implements two traits: a server to connect to, and the
//! connection that looks up, reads and writes symbols. Requests are sent only by calls of the caller, and nothing
//! is written before [`crate::Controller::arm`].

pub(crate) mod access;
mod controller;
mod layout;
mod pose;
mod sample;

use tautline_core::robot::Robot;
use tautline_session::SymbolMapping;

pub(crate) use access::{
    Content, Expected, Failure, SymbolAccess, SymbolServer, SymbolValues, ValueKind, each_once,
};
pub use access::{SymbolCheck, SymbolFound};
pub use controller::SymbolController;
use layout::Layout;
pub(crate) use layout::{RequiredSymbol, Slot};

use crate::error::LinkError;

/// Connects, looks up every symbol of a mapping, and disconnects.
pub(crate) fn check(
    server: &dyn SymbolServer,
    mapping: &SymbolMapping,
    robot: &Robot,
) -> Result<Vec<SymbolCheck>, LinkError> {
    let wanted = Layout::of(mapping, robot)?.wanted;
    let found = server.connect()?.look_up(&wanted)?;
    let names = wanted.into_iter().map(|wanted| wanted.name);
    let all = names.zip(found);
    Ok(all
        .map(|(name, found)| SymbolCheck { name, found })
        .collect())
}

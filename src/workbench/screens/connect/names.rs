//! Names of the symbols of a kind of controller.

use tautline_core::robot::Robot;
use tautline_session::{ControllerKind, SymbolMapping};

use super::problems::Problems;
use super::symbols::SymbolRows;

/// Names of symbols.
#[derive(Debug)]
pub struct Names {
    /// Whether they are one's own.
    pub own: bool,
    /// The names.
    pub rows: SymbolRows,
}

impl Names {
    /// Those of one's own, or else the usual ones.
    #[must_use]
    pub fn of(own: Option<&SymbolMapping>, default: &SymbolMapping, robot: &Robot) -> Self {
        Self {
            own: own.is_some(),
            rows: SymbolRows::of(own.unwrap_or(default), robot),
        }
    }

    /// The mapping; `None` where it is the usual one or wrong.
    pub fn mapping(&self, robot: &Robot, problems: &mut Problems) -> Option<SymbolMapping> {
        self.own.then(|| self.rows.mapping(robot, problems))?
    }
}

/// The usual names of a kind of controller.
pub fn default_names(kind: ControllerKind, robot: &Robot) -> SymbolMapping {
    match kind {
        ControllerKind::OpcUa => SymbolMapping::default_nodes_for(robot),
        _ => SymbolMapping::default_for(robot),
    }
}

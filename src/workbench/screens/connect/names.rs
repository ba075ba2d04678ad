//! Names of the symbols of a kind of controller.

use tautline_core::robot::Robot;
use tautline_session::{ControllerKind, SymbolMapping};

use super::problems::Problems;
use super::symbols::SymbolRows;

#[derive(Debug)]
pub struct Names {
    /// Whether the names are set by the operator instead of the defaults of the controller.
    pub is_custom: bool,
    pub rows: SymbolRows,
}

impl Names {
    /// Custom names, or the defaults.
    #[must_use]
    pub fn of(custom: Option<&SymbolMapping>, default: &SymbolMapping, robot: &Robot) -> Self {
        Self {
            is_custom: custom.is_some(),
            rows: SymbolRows::of(custom.unwrap_or(default), robot),
        }
    }

    /// Mapping; `None` if it is the default or invalid.
    pub fn mapping(&self, robot: &Robot, problems: &mut Problems) -> Option<SymbolMapping> {
        self.is_custom.then(|| self.rows.mapping(robot, problems))?
    }
}

pub fn default_names(kind: ControllerKind, robot: &Robot) -> SymbolMapping {
    match kind {
        ControllerKind::OpcUa => SymbolMapping::default_nodes_for(robot),
        _ => SymbolMapping::default_for(robot),
    }
}

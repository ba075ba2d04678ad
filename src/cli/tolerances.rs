//! `--tolerances`.

use tautline_core::robot::{PartTolerances, Robot};
use tautline_workflow::identification::TolerancesUsed;

/// Which tolerances of the parts count.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum TolerancesName {
    /// Those that robot.json states; none if it states none
    Stated,
    /// Those of the catalogue
    Typical,
    /// None: all parts are exact
    None,
}

impl From<TolerancesName> for TolerancesUsed {
    fn from(name: TolerancesName) -> Self {
        match name {
            TolerancesName::Stated => Self::Stated,
            TolerancesName::Typical => Self::Typical,
            TolerancesName::None => Self::None,
        }
    }
}

impl TolerancesName {
    /// Writes these tolerances into the description of a robot.
    pub fn state(self, robot: &mut Robot) {
        match self {
            Self::Stated => {}
            Self::Typical => robot.tolerances = Some(PartTolerances::typical()),
            Self::None => robot.tolerances = None,
        }
    }
}

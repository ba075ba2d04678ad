//! Why reading a part of a file ended.

use crate::memory::OverBudget;

/// Why a part of a file is not read.
pub(super) enum Fault {
    Damaged,
    Large(OverBudget),
}

impl From<OverBudget> for Fault {
    fn from(over: OverBudget) -> Self {
        Self::Large(over)
    }
}

//! Errors of reading a part of a file.

use std::io;

use crate::memory::OverBudget;

/// Reason why a part of a file is not read.
pub(super) enum Fault {
    Damaged,
    Large(OverBudget),
}

impl From<OverBudget> for Fault {
    fn from(over: OverBudget) -> Self {
        Self::Large(over)
    }
}

/// An error of decompressed content.
impl From<io::Error> for Fault {
    fn from(error: io::Error) -> Self {
        error.downcast().map_or(Self::Damaged, Self::Large)
    }
}

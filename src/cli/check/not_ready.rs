//! The exit code of a check that failed.

use std::fmt;

/// Exit code if a part of the check failed; its results are written and name that part.
pub const EXIT_CODE: u8 = 5;

/// A part of the check failed.
#[derive(Debug)]
pub struct NotReady;

impl fmt::Display for NotReady {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("the check failed: correct what it names before identification")
    }
}

impl std::error::Error for NotReady {}

//! The exit code of a fit that did not converge.

use std::fmt;

/// Exit code of a command whose fit did not converge; its results are written and say so.
pub const EXIT_CODE: u8 = 3;

/// The fit of a command did not converge.
#[derive(Debug)]
pub struct NotConverged;

impl NotConverged {
    /// Fails unless the fit has converged.
    pub fn check(converged: bool) -> anyhow::Result<()> {
        if converged { Ok(()) } else { Err(Self.into()) }
    }
}

impl fmt::Display for NotConverged {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("the fit did not converge: do not rely on its values")
    }
}

impl std::error::Error for NotConverged {}

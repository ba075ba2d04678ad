//! Failures of a command that have an exit code of their own.

use std::fmt::Display;

/// Invalid input that the user must correct.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct BadInput(String);

impl BadInput {
    /// Exit code of a command with invalid input.
    pub const EXIT_CODE: u8 = 2;

    #[expect(
        clippy::new_ret_no_self,
        reason = "commands only return it, as the error of their result"
    )]
    /// An error whose message names the file, the position in it, what was found and what was expected.
    pub fn new(message: impl Display) -> anyhow::Error {
        Self(message.to_string()).into()
    }
}

/// A failure of a command that wrote its results, which state the problem; the number is its exit code.
#[derive(Debug, Clone, Copy, thiserror::Error)]
#[repr(u8)]
pub enum Reservation {
    #[error("the fit did not converge: do not rely on its values")]
    NotConverged = 3,
    /// `adjust` settled an earlier, interrupted attempt; the result states the values in the controller.
    #[error("an earlier attempt was settled, nothing else was written: run the same command again")]
    Settled = 4,
    /// A part of `check` failed.
    #[error("the check failed: correct what it names before identification")]
    NotReady = 5,
}

impl Reservation {
    /// Fails with this reservation unless `all_is_well`.
    pub fn unless(self, all_is_well: bool) -> anyhow::Result<()> {
        if all_is_well {
            Ok(())
        } else {
            Err(self.into())
        }
    }
}

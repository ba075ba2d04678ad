//! Input that the user has to correct.

/// Input that the user has to correct; ends the program with exit code 2.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct BadInput(String);

impl BadInput {
    #[expect(
        clippy::new_ret_no_self,
        reason = "commands only return it, as the error of their result"
    )]
    /// The error with a message that names file, place, what was found and what was expected.
    pub fn new(message: impl std::fmt::Display) -> anyhow::Error {
        Self(message.to_string()).into()
    }
}

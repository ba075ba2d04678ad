//! Invalid input that the user must correct.

use std::fmt::{self, Display};

/// Invalid input that the user must correct; ends the program with exit code 2.
#[derive(Debug)]
pub struct BadInput(String);

impl BadInput {
    #[expect(
        clippy::new_ret_no_self,
        reason = "commands only return it, as the error of their result"
    )]
    /// An error whose message names the file, the position in it, what was found and what was expected.
    pub fn new(message: impl Display) -> anyhow::Error {
        Self(message.to_string()).into()
    }
}

impl Display for BadInput {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for BadInput {}

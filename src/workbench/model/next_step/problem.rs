//! Problems with their remedies.

use super::{Action, Remedy};

/// Problem, shown in red on a screen.
#[derive(Debug, Clone)]
pub struct Problem {
    pub text: String,
    /// Remedy; `None` if no button can do it.
    pub remedy: Option<Action>,
    /// Sentence about the step after the remedy; or instructions if no button can do it.
    pub then: String,
}

impl Problem {
    pub(super) fn new(text: impl Into<String>, remedy: Remedy) -> Self {
        Self {
            text: text.into(),
            remedy: remedy.action,
            then: remedy.then,
        }
    }
}

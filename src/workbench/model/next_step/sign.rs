//! What is wrong, with what remedies it.

use super::Action;

/// Something wrong, which a screen shows in red.
#[derive(Debug, Clone)]
pub struct Sign {
    pub text: String,
    /// What remedies it; `None` where no button can.
    pub remedy: Option<Action>,
    /// What comes after the remedy; or what to do where no button can do it.
    pub then: String,
}

impl Sign {
    pub(super) fn new(
        text: impl Into<String>,
        remedy: Option<Action>,
        then: impl Into<String>,
    ) -> Self {
        Self {
            text: text.into(),
            remedy,
            then: then.into(),
        }
    }
}

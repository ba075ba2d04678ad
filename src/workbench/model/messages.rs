//! Messages to the operator: the last one is in the status bar, all of them in the log.

use tautline_session::Timestamp;

use tautline_workflow::clock;
use tautline_workflow::wording::sentence;

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// Good to know.
    Info,
    /// Something is not as expected.
    Warning,
    /// Something did not work.
    Error,
}

/// What an error is about: once that has been done after all, the error is no longer shown above the window.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Cause {
    /// Reading a file or a session.
    Opening,
    Saving,
    /// Keeping unsaved changes on disk.
    Autosave,
    /// What was typed.
    Entry,
    Connection,
    Adjustment,
    Planning,
    Estimation,
    Comparison,
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Message {
    pub time: Timestamp,
    pub severity: Severity,
    pub text: String,
}

/// Messages since the program began, the oldest first.
#[derive(Debug, Default)]
pub struct Messages {
    all: Vec<Message>,
    /// The last error, until the operator has seen it or its cause is gone.
    alert: Option<(Message, Option<Cause>)>,
    /// How many there were at the end of the last frame.
    known: usize,
    /// How many were said on screens that were left.
    left: usize,
}

/// Older messages are dropped beyond this number.
const MOST: usize = 2000;

impl Messages {
    /// Adds a message to the log alone.
    pub(crate) fn log(&mut self, severity: Severity, text: impl Into<String>) {
        if self.all.len() == MOST {
            self.all.remove(0);
            self.known = self.known.saturating_sub(1);
            self.left = self.left.saturating_sub(1);
        }
        self.all.push(Message {
            time: clock::now(),
            severity,
            text: text.into(),
        });
    }

    pub fn info(&mut self, text: impl Into<String>) {
        self.log(Severity::Info, text);
    }

    pub fn warning(&mut self, text: impl Into<String>) {
        self.log(Severity::Warning, text);
    }

    /// Adds an error, which is shown until the operator has seen it.
    pub fn error(&mut self, text: impl Into<String>) {
        self.alarm(None, text);
    }

    /// Adds an error, which is shown until the operator has seen it or [`Self::resolve`] ends its cause.
    pub(crate) fn failure(&mut self, cause: Cause, text: impl Into<String>) {
        self.alarm(Some(cause), text);
    }

    fn alarm(&mut self, cause: Option<Cause>, text: impl Into<String>) {
        self.log(Severity::Error, text);
        self.alert = self.all.last().map(|message| (message.clone(), cause));
    }

    /// The cause of an error is gone, or is tried anew.
    pub(crate) fn resolve(&mut self, cause: Cause) {
        self.alert.take_if(|(_, of)| *of == Some(cause));
    }

    /// The error that is shown above the window.
    #[must_use]
    pub fn alert(&self) -> Option<&Message> {
        self.alert.as_ref().map(|(message, _)| message)
    }

    /// Whether the error that is shown is one of saving.
    #[must_use]
    pub fn failed_to_save(&self) -> bool {
        self.alert
            .as_ref()
            .is_some_and(|(_, of)| *of == Some(Cause::Saving))
    }

    /// The operator has seen the last error.
    pub fn dismiss(&mut self) {
        self.alert = None;
    }

    #[must_use]
    pub fn all(&self) -> &[Message] {
        &self.all
    }

    #[must_use]
    pub fn last(&self) -> Option<&Message> {
        self.all.last()
    }

    /// The last message on the present screen.
    #[must_use]
    pub fn last_here(&self) -> Option<&Message> {
        self.all.get(self.left..)?.last()
    }

    /// The screen was left; what was said along with that belongs to the next one.
    pub(crate) fn leave(&mut self) {
        self.left = self.known;
    }

    /// A frame has ended.
    pub(crate) fn mark(&mut self) {
        self.known = self.all.len();
    }
}

/// A text as a sentence: with a capital letter first and a full stop at its end.
#[must_use]
pub fn full_sentence(text: &str) -> String {
    format!("{}.", sentence(text.trim_end_matches('.')))
}

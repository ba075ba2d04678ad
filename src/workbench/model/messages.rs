//! Messages to the operator: the last one is in the status bar, all are in the log.

use tautline_session::Timestamp;

use tautline_workflow::clock;
use tautline_workflow::wording::sentence;

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// Information.
    Info,
    /// Unexpected, but not an error.
    Warning,
    /// A failure.
    Error,
}

/// Cause of an error; once it is resolved, the error is no longer shown above the window.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Cause {
    /// Reading a file or a session.
    Opening,
    Saving,
    /// Writing unsaved changes to the recovery folder.
    Autosave,
    /// Input of the operator.
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

/// Messages since the start of the program, oldest first.
#[derive(Debug, Default)]
pub struct Messages {
    all: Vec<Message>,
    /// Last error, until it is dismissed or its cause is resolved.
    alert: Option<(Message, Option<Cause>)>,
    /// Number of messages at the end of the last frame.
    known: usize,
    /// Number of messages from earlier screens.
    left: usize,
}

/// Largest number of messages; older ones are dropped.
const MOST: usize = 2000;

impl Messages {
    /// Adds a message to the log only.
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

    pub fn warnings(&mut self, texts: impl IntoIterator<Item = String>) {
        texts.into_iter().for_each(|text| self.warning(text));
    }

    pub fn warning(&mut self, text: impl Into<String>) {
        self.log(Severity::Warning, text);
    }

    /// Adds an error, which is shown until it is dismissed.
    pub fn error(&mut self, text: impl Into<String>) {
        self.alarm(None, text);
    }

    /// Adds an error, which is shown until it is dismissed or [`Self::resolve`] is called for its cause.
    pub(crate) fn failure(&mut self, cause: Cause, text: impl Into<String>) {
        self.alarm(Some(cause), text);
    }

    fn alarm(&mut self, cause: Option<Cause>, text: impl Into<String>) {
        self.log(Severity::Error, text);
        self.alert = self.all.last().map(|message| (message.clone(), cause));
    }

    /// Hides the error of a cause that is gone or is being retried.
    pub(crate) fn resolve(&mut self, cause: Cause) {
        self.alert.take_if(|(_, of)| *of == Some(cause));
    }

    /// Error shown above the window.
    #[must_use]
    pub fn alert(&self) -> Option<&Message> {
        self.alert.as_ref().map(|(message, _)| message)
    }

    /// Whether the error shown is one of saving.
    #[must_use]
    pub fn failed_to_save(&self) -> bool {
        self.alert
            .as_ref()
            .is_some_and(|(_, of)| *of == Some(Cause::Saving))
    }

    /// Dismisses the last error.
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

    /// Last message of the present screen.
    #[must_use]
    pub fn last_here(&self) -> Option<&Message> {
        self.all.get(self.left..)?.last()
    }

    /// Leaves a screen; messages of the present frame belong to the next screen.
    pub(crate) fn leave(&mut self) {
        self.left = self.known;
    }

    /// Marks the end of a frame.
    pub(crate) fn mark(&mut self) {
        self.known = self.all.len();
    }
}

/// Text as a sentence, with a capital letter and a full stop.
#[must_use]
pub fn full_sentence(text: &str) -> String {
    format!("{}.", sentence(text.trim_end_matches('.')))
}

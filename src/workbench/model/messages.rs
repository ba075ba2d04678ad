//! Messages to the operator: the last one is in the status bar, all of them in the log.

use tautline_session::Timestamp;

use tautline_workflow::clock;
use tautline_workflow::wording::sentence;

/// How much a message matters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// Good to know.
    Info,
    /// Something is not as expected.
    Warning,
    /// Something did not work.
    Error,
}

/// One message.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Message {
    /// When.
    pub time: Timestamp,
    /// How much it matters.
    pub severity: Severity,
    /// One sentence.
    pub text: String,
}

/// Messages since the program began, the oldest first.
#[derive(Debug, Default)]
pub struct Messages {
    all: Vec<Message>,
    /// The last error, until the operator has seen it.
    alert: Option<Message>,
}

/// Older messages are dropped beyond this number.
const MOST: usize = 2000;

impl Messages {
    /// Adds a message.
    pub fn add(&mut self, severity: Severity, text: impl Into<String>) {
        if self.all.len() == MOST {
            self.all.remove(0);
        }
        let message = Message {
            time: clock::now(),
            severity,
            text: text.into(),
        };
        if severity == Severity::Error {
            self.alert = Some(message.clone());
        }
        self.all.push(message);
    }

    /// Adds a message of severity info.
    pub fn info(&mut self, text: impl Into<String>) {
        self.add(Severity::Info, text);
    }

    /// Adds a warning.
    pub fn warning(&mut self, text: impl Into<String>) {
        self.add(Severity::Warning, text);
    }

    /// Adds an error.
    pub fn error(&mut self, text: impl Into<String>) {
        self.add(Severity::Error, text);
    }

    /// The last error, until [`Self::dismiss`].
    #[must_use]
    pub fn alert(&self) -> Option<&Message> {
        self.alert.as_ref()
    }

    /// The operator has seen the last error.
    pub fn dismiss(&mut self) {
        self.alert = None;
    }

    /// All messages, the oldest first.
    #[must_use]
    pub fn all(&self) -> &[Message] {
        &self.all
    }

    /// The newest message.
    #[must_use]
    pub fn last(&self) -> Option<&Message> {
        self.all.last()
    }
}

/// A text as a sentence: with a capital letter first and a full stop at its end.
#[must_use]
pub fn full_sentence(text: &str) -> String {
    format!("{}.", sentence(text.trim_end_matches('.')))
}

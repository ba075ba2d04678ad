//! Sessions: one calibration of one robot, with everything that was measured and concluded.

mod document;
mod log;
mod measurement_table;
mod settings;
mod timestamp;

use std::path::Path;

use tautline_core::measurement::{Dataset, Measurements};
use tautline_core::robot::{FieldError, Robot};

use crate::error::{Loaded, Place, ReadError, WriteError};
use crate::json::{parse_document, read_document, write_document};
use crate::phases::PhaseData;
pub(crate) use document::SessionDocument;
pub use log::{LogEntry, Phase, ResultRecord};
pub use settings::{DiagnosisSettings, FreeEffect, IdentificationSettings, Method, Settings};
pub use timestamp::{NotATimestamp, Timestamp};

/// One calibration of one robot.
///
/// Measurements may still be incomplete: a session is saved at any time, while a dataset folder
/// has to be usable.
#[derive(Debug, Clone, PartialEq)]
pub struct Session {
    /// Name by which the operator knows it.
    pub name: String,
    /// When it was begun.
    pub created: Timestamp,
    /// When it was last changed.
    pub modified: Timestamp,
    /// The robot as the drawings and the first two phases describe it.
    pub robot: Robot,
    /// Measured poses.
    pub measurements: Measurements,
    /// Raw data of the phases around the poses.
    pub phases: PhaseData,
    /// How identification and diagnosis are to work.
    pub settings: Settings,
    results: Vec<ResultRecord>,
    log: Vec<LogEntry>,
}

impl Session {
    /// An empty session of a robot.
    #[must_use]
    pub fn new(name: impl Into<String>, robot: Robot, now: Timestamp) -> Self {
        Self {
            name: name.into(),
            created: now,
            modified: now,
            robot,
            measurements: Measurements::default(),
            phases: PhaseData::default(),
            settings: Settings::default(),
            results: Vec::new(),
            log: Vec::new(),
        }
    }

    /// The robot and its measurements as identification takes them.
    #[must_use]
    pub fn dataset(&self) -> Dataset {
        Dataset {
            robot: self.robot.clone(),
            measurements: self.measurements.clone(),
        }
    }

    /// Results so far, the oldest first.
    #[must_use]
    pub fn results(&self) -> &[ResultRecord] {
        &self.results
    }

    /// What the operator did so far, the oldest first.
    #[must_use]
    pub fn log(&self) -> &[LogEntry] {
        &self.log
    }

    /// Adds a result; results are never changed afterwards.
    pub fn add_result(&mut self, result: ResultRecord) {
        self.modified = self.modified.max(result.time);
        self.results.push(result);
    }

    /// Adds an operator step; the log is never changed afterwards.
    pub fn record(&mut self, entry: LogEntry) {
        self.modified = self.modified.max(entry.time);
        self.log.push(entry);
    }
}

/// Reads a session file.
///
/// # Errors
/// If the file cannot be read or is no valid session.
pub fn read_session(path: &Path) -> Result<Loaded<Session>, ReadError> {
    from_document(read_document(path)?, &path.display().to_string())
}

/// Reads a session from memory; `file` is the name for messages.
///
/// # Errors
/// If the bytes are no valid session.
pub fn parse_session(bytes: &[u8], file: &str) -> Result<Loaded<Session>, ReadError> {
    from_document(parse_document(bytes, file)?, file)
}

fn from_document(
    loaded: Loaded<SessionDocument>,
    file: &str,
) -> Result<Loaded<Session>, ReadError> {
    let value = loaded.value.into_session().map_err(|error| {
        let FieldError { pointer, message } = error;
        ReadError::new(file, Place::Pointer(pointer), message)
    })?;
    Ok(Loaded {
        value,
        notices: loaded.notices,
    })
}

/// Writes a session file, atomically.
///
/// # Errors
/// If the session could not be read again or the file cannot be written.
pub fn write_session(path: &Path, session: &Session) -> Result<(), WriteError> {
    let document = SessionDocument::of(session);
    document
        .clone()
        .into_session()
        .map_err(|error| WriteError::Content {
            path: path.into(),
            message: error.to_string(),
        })?;
    write_document(path, &document)
}

#[cfg(test)]
mod tests;

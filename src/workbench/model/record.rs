//! The open record of a robot: its sessions and their changes over time.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use tautline_workflow::health::HealthVerdict;
use tautline_workflow::history::{RobotHistory, RobotRecord, Tolerance};

/// Record with its history.
#[derive(Debug, Clone)]
pub struct OpenRecord {
    pub folder: PathBuf,
    pub record: RobotRecord,
    pub found: RobotHistory,
}

/// Session of the record that was checked against another one.
#[derive(Debug, Clone)]
pub struct CheckedPair {
    /// Baseline and check, by their indices in order of time.
    pub sessions: [usize; 2],
    /// Verdict with its sentences, or the reason why there is none.
    pub result: Result<(HealthVerdict, Vec<String>), String>,
}

/// State of the record.
#[derive(Debug, Default)]
pub struct RecordState {
    folder: Option<PathBuf>,
    /// Monitored quantity.
    pub tolerance: Tolerance,
    result: Option<Result<Arc<OpenRecord>, String>>,
    /// Last health check.
    pub checked: Option<CheckedPair>,
    number: u64,
}

impl RecordState {
    /// Chosen folder.
    #[must_use]
    pub fn folder(&self) -> Option<&Path> {
        self.folder.as_deref()
    }

    /// Record, or an error message.
    #[must_use]
    pub fn result(&self) -> Option<&Result<Arc<OpenRecord>, String>> {
        self.result.as_ref()
    }

    /// Record, if it is open.
    #[must_use]
    pub fn open(&self) -> Option<&Arc<OpenRecord>> {
        self.result.as_ref()?.as_ref().ok()
    }

    /// Begins to read a folder and returns the number of this reading. Another folder belongs to another robot and gets
    /// its own tolerance.
    pub fn begin(&mut self, folder: PathBuf) -> u64 {
        if self.folder.as_ref() != Some(&folder) {
            self.tolerance = Tolerance::default();
        }
        self.folder = Some(folder);
        (self.result, self.checked) = (None, None);
        self.number += 1;
        self.number
    }

    /// Closes the record.
    pub fn clear(&mut self) {
        (self.folder, self.result, self.checked) = (None, None, None);
        self.number += 1;
    }

    /// Number of the present reading, for computations from it.
    #[must_use]
    pub fn number(&self) -> u64 {
        self.number
    }

    /// Whether this is the number of the present reading.
    #[must_use]
    pub fn expects(&self, number: u64) -> bool {
        self.number == number
    }

    pub fn take(&mut self, result: Result<Arc<OpenRecord>, String>) {
        self.result = Some(result);
    }

    /// Sets the tolerance, from which the date of the next calibration follows.
    ///
    /// # Errors
    /// An error message without full stop, if nothing can be stated for this tolerance; the earlier one stays.
    pub fn set_tolerance(&mut self, tolerance: Tolerance) -> Result<(), String> {
        if let Some(Ok(open)) = &mut self.result {
            let mut changed = OpenRecord::clone(open);
            changed.found.set_tolerance(&changed.record, tolerance)?;
            *open = Arc::new(changed);
        }
        self.tolerance = tolerance;
        Ok(())
    }
}

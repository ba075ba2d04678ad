//! The record of a robot that is open: its sessions and what changed between them.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use tautline_workflow::health::HealthVerdict;
use tautline_workflow::history::{RobotHistory, RobotRecord, Tolerance};

/// A record with its history.
#[derive(Debug, Clone)]
pub struct OpenRecord {
    /// Its folder.
    pub folder: PathBuf,
    pub record: RobotRecord,
    pub found: RobotHistory,
}

/// A session of the record that was checked against another one.
#[derive(Debug, Clone)]
pub struct CheckedPair {
    /// Baseline and check, by their places in the order of time.
    pub sessions: [usize; 2],
    /// The verdict with its sentences, or why there is none.
    pub result: Result<(HealthVerdict, Vec<String>), String>,
}

/// The record on the screen.
#[derive(Debug, Default)]
pub struct RecordState {
    folder: Option<PathBuf>,
    /// Monitored quantity.
    pub tolerance: Tolerance,
    result: Option<Result<Arc<OpenRecord>, String>>,
    /// The last health check.
    pub checked: Option<CheckedPair>,
    number: u64,
}

impl RecordState {
    /// The folder that was chosen.
    #[must_use]
    pub fn folder(&self) -> Option<&Path> {
        self.folder.as_deref()
    }

    /// The record, or why it cannot be opened.
    #[must_use]
    pub fn result(&self) -> Option<&Result<Arc<OpenRecord>, String>> {
        self.result.as_ref()
    }

    /// The record, if it is open.
    #[must_use]
    pub fn open(&self) -> Option<&Arc<OpenRecord>> {
        self.result.as_ref()?.as_ref().ok()
    }

    /// Begins to read a folder: the number of its result. A tolerance is one of the robot, so that another folder has its own.
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

    /// The number of what is read now, for what is computed from it.
    #[must_use]
    pub fn number(&self) -> u64 {
        self.number
    }

    /// Whether the result of this number is waited for.
    #[must_use]
    pub fn expects(&self, number: u64) -> bool {
        self.number == number
    }

    pub fn take(&mut self, result: Result<Arc<OpenRecord>, String>) {
        self.result = Some(result);
    }

    /// Changes the tolerance, on which the date of the next calibration depends.
    ///
    /// # Errors
    /// One sentence without its end, if nothing can be said for this tolerance. The former one stays.
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

//! Edits since the snapshot.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tautline_core::robot::FieldError;

use crate::error::below;
use crate::json::VersionedFile;
use crate::session::{ResultRecord, Session, SessionFile};

/// A session without its measured poses, for [`RecoveryWriter::write_changes`](super::RecoveryWriter::write_changes):
/// its size does not depend on the number of measured poses.
#[derive(Debug, Clone, PartialEq)]
pub struct SessionChanges {
    session: SessionFile,
    measured: Vec<i64>,
}

impl SessionChanges {
    /// The session in its present state; the first `rows` of its poses are those of the snapshot.
    #[must_use]
    pub fn of(session: &Session, rows: usize) -> Self {
        let since = session.measurements.labels.get(rows..);
        Self {
            session: SessionFile::without_measurements(session),
            measured: since.unwrap_or_default().to_vec(),
        }
    }

    /// Removes the results, which are stored in a separate file.
    pub(super) fn take_results(&mut self) -> Vec<ResultRecord> {
        std::mem::take(self.session.results_mut())
    }

    /// The file content for the snapshot with this fingerprint.
    pub(super) fn since(self, snapshot: String) -> ChangesFile {
        ChangesFile {
            snapshot,
            measured: self.measured,
            session: self.session,
        }
    }
}

/// Changes in stored form.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub(super) struct ChangesFile {
    /// Fingerprint of the snapshot they belong to; with any other snapshot they are ignored.
    pub snapshot: String,
    /// Labels of the poses in the journal that the session had.
    pub measured: Vec<i64>,
    /// The session without its measured poses and its results.
    pub session: SessionFile,
}

impl VersionedFile for ChangesFile {
    const FORMAT: &'static str = "tautline-changes";
    const VERSION: u32 = 1;
    const MAX_BYTES: u64 = SessionFile::MAX_BYTES;

    fn check(&self) -> Result<(), FieldError> {
        let checked = self.session.check();
        checked.map_err(|error| below("/session", error))
    }
}

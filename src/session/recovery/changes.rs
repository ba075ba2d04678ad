//! What was changed since the snapshot, besides measured poses.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tautline_core::robot::FieldError;

use crate::json::Document;
use crate::session::{ResultRecord, Session, SessionDocument};

/// A session without its measured poses, for [`Keeper::changed`](super::Keeper::changed): as large as
/// what the operator edits, however much is measured.
#[derive(Debug, Clone, PartialEq)]
pub struct Changes {
    session: SessionDocument,
    measured: Vec<i64>,
}

impl Changes {
    /// The session as it is now; its first `rows` poses are those of the snapshot.
    #[must_use]
    pub fn of(session: &Session, rows: usize) -> Self {
        let since = session.measurements.labels.get(rows..);
        Self {
            session: SessionDocument::without_measurements(session),
            measured: since.unwrap_or_default().to_vec(),
        }
    }

    /// Takes the results out, which are kept otherwise.
    pub(super) fn take_results(&mut self) -> Vec<ResultRecord> {
        std::mem::take(self.session.results_mut())
    }

    /// As a document that belongs to the snapshot of this fingerprint.
    pub(super) fn since(self, snapshot: String) -> ChangesDocument {
        ChangesDocument {
            snapshot,
            measured: self.measured,
            session: self.session,
        }
    }
}

/// Changes as they are stored.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub(super) struct ChangesDocument {
    /// Fingerprint of the snapshot that they follow; with any other snapshot they are older than it.
    pub snapshot: String,
    /// Labels of the poses of the journal that the session had.
    pub measured: Vec<i64>,
    /// The session without its measured poses and its results.
    pub session: SessionDocument,
}

impl Document for ChangesDocument {
    const FORMAT: &'static str = "tautline-changes";
    const VERSION: u32 = 1;
    const MAX_BYTES: u64 = SessionDocument::MAX_BYTES;

    fn check(&self) -> Result<(), FieldError> {
        self.session.check().map_err(|error| FieldError {
            pointer: format!("/session{}", error.pointer),
            ..error
        })
    }
}

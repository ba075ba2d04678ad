//! Recovery of unsaved sessions after a crash.
//!
//! Each open session has a folder of its own in the recovery folder:
//!
//! ```text
//! session-a1b2c3.lock     locked while the program that has the session open runs
//! session-a1b2c3/
//!   snapshot.json         the whole session at some time
//!   journal.jsonl         poses measured since then, one per line
//!   changes.json          the session without its poses and results after its last edit
//!   results.jsonl         results added since then, one per line
//!   origin.json           the file that the session was opened from
//! ```
//!
//! A measured pose adds one line to the journal, a result adds one line to the results, and an edit replaces the changes,
//! which contain neither. Only measurements that arrive in another way, such as from a file, need a new snapshot. So
//! the amount of data written is proportional to the measurements and edits, not to their square.
//!
//! A snapshot is complete before the journal is shortened, so that at any moment both together contain every measured
//! pose. A pose in both is recognised by its label, a result by its number. Changes state the snapshot that they
//! belong to by its fingerprint, and are ignored with any other.

mod changes;
mod journal;
mod own_files;
mod results;
mod unsaved;
mod writer;

use std::path::Path;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::error::WriteError;
use crate::json::{VersionedFile, write_versioned};
pub use changes::SessionChanges;
pub use own_files::remove_discarded;
pub use unsaved::{RecoveredSession, UnsavedSession, find_unsaved_sessions};
pub use writer::RecoveryWriter;

const SNAPSHOT: &str = "snapshot.json";
const JOURNAL: &str = "journal.jsonl";
const CHANGES: &str = "changes.json";
const RESULTS: &str = "results.jsonl";
const ORIGIN: &str = "origin.json";
/// Prefix of the names of session folders.
const PREFIX: &str = "session-";
const LOCK: &str = "lock";
/// Folder for the files of recovered or discarded sessions.
const DISCARDED: &str = "discarded";
/// Extension of the folders of saved sessions that are about to be removed.
const FINISHED: &str = "finished";

/// The file that a session was opened from.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
struct Origin {
    /// Path of the file; absent if the session was never saved, or if the path is not valid Unicode.
    #[serde(default)]
    path: Option<String>,
}

impl VersionedFile for Origin {
    const FORMAT: &'static str = "tautline-origin";
    const VERSION: u32 = 1;
    const MAX_BYTES: u64 = 1 << 20;
}

fn write_origin(folder: &Path, origin: Option<&Path>) -> Result<(), WriteError> {
    let absolute = origin.and_then(|path| std::path::absolute(path).ok());
    let path = absolute.and_then(|path| path.to_str().map(str::to_owned));
    write_versioned(&folder.join(ORIGIN), &Origin { path })
}

#[cfg(test)]
mod tests;

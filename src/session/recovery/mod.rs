//! What is not saved yet survives a crash.
//!
//! For each open session the recovery folder has a folder of its own:
//!
//! ```text
//! session-a1b2c3.lock     locked while the program that keeps the session lives
//! session-a1b2c3/
//!   snapshot.json         the session as it was at some time
//!   journal.jsonl         poses measured since, one per line
//!   changes.json          the session without its poses and results as it was later, if it was changed
//!   results.jsonl         results added since, one per line
//!   origin.json           the file that the session belongs to
//! ```
//!
//! A measured pose is a line of the journal and nothing else, a result one of the results; an edit replaces the
//! changes, which hold neither; only where measurements come otherwise, as from a file, is there a new snapshot. So what is
//! written grows as what is measured and edited, not as its square.
//!
//! A snapshot is complete before the journal is shortened, so that at any moment both together hold
//! every measured pose. A pose that is in both is recognised by its label, a result by its number. Changes name the snapshot that
//! they follow by its fingerprint: those of an older one count no more.

mod changes;
mod journal;
mod keeper;
mod left_behind;
mod results;

use std::path::Path;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tautline_core::robot::FieldError;

use crate::error::WriteError;
use crate::json::{Document, write_document};
pub use changes::Changes;
pub use keeper::Keeper;
pub use left_behind::{LeftBehind, Recovered, left_behind};

const SNAPSHOT: &str = "snapshot.json";
const JOURNAL: &str = "journal.jsonl";
const CHANGES: &str = "changes.json";
const RESULTS: &str = "results.jsonl";
const ORIGIN: &str = "origin.json";
/// Beginning of the names of the folders of sessions.
const PREFIX: &str = "session-";
const LOCK: &str = "lock";
/// Where recovered and unwanted sessions go.
const DISCARDED: &str = "discarded";
/// Folders of finished sessions that are about to be removed.
const FINISHED: &str = "finished";

/// The file that a session belongs to.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
struct Origin {
    /// Its path; absent if the session was never saved, or if the path is no text.
    #[serde(default)]
    path: Option<String>,
}

impl Document for Origin {
    const FORMAT: &'static str = "tautline-origin";
    const VERSION: u32 = 1;
    const MAX_BYTES: u64 = 1 << 20;

    fn check(&self) -> Result<(), FieldError> {
        Ok(())
    }
}

fn write_origin(folder: &Path, origin: Option<&Path>) -> Result<(), WriteError> {
    let absolute = origin.and_then(|path| std::path::absolute(path).ok());
    let path = absolute.and_then(|path| path.to_str().map(str::to_owned));
    write_document(&folder.join(ORIGIN), &Origin { path })
}

#[cfg(test)]
mod tests;

//! Importing the tables of phases 1 and 2.

use std::path::PathBuf;

use tautline_session::Loaded;
use tautline_workflow::precalibration::{Table, TableRows};

/// Imports a table.
#[derive(Debug, Clone)]
pub enum ImportCommand {
    /// Asks for its file.
    Ask(Table),
    /// Reads it from a file.
    Read(Table, PathBuf),
}

/// What an import came to.
#[derive(Debug)]
pub enum ImportOutcome {
    /// A file dialog was closed.
    Picked {
        /// The table it was for.
        table: Table,
        /// What was picked; `None` if the dialog was cancelled or is not available.
        path: Option<PathBuf>,
    },
    /// A file was read.
    Read {
        /// The file.
        path: PathBuf,
        /// Its rows, or one sentence.
        result: Result<Loaded<TableRows>, String>,
    },
}

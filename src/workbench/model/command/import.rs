//! Importing the tables of phases 1 and 2.

use std::path::PathBuf;

use tautline_session::Loaded;
use tautline_workflow::precalibration::{Table, TableRows};

#[derive(Debug, Clone)]
pub enum ImportCommand {
    /// Asks for the file of a table.
    Ask(Table),
    Read(Table, PathBuf),
    /// Shows the table in its phase.
    Show(Table),
}

#[derive(Debug)]
pub struct ImportOutcome {
    /// Its file.
    pub path: PathBuf,
    /// Rows of the table, or an error message.
    pub result: Result<Loaded<TableRows>, String>,
}

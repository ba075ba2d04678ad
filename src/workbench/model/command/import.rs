//! Importing the tables of phases 1 and 2.

use std::path::PathBuf;

use tautline_session::Loaded;
use tautline_workflow::precalibration::{Table, TableRows};

#[derive(Debug, Clone)]
pub enum ImportCommand {
    /// Asks for its file.
    Ask(Table),
    Read(Table, PathBuf),
    /// Goes to where it is shown.
    Show(Table),
}

#[derive(Debug)]
pub struct ImportOutcome {
    /// Its file.
    pub path: PathBuf,
    /// Its rows, or one sentence.
    pub result: Result<Loaded<TableRows>, String>,
}

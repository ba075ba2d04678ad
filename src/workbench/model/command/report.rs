//! Writing the report.

use std::path::PathBuf;

use tautline_workflow::report::{ReportChoice, ReportFormat};

/// Saves the report of the session.
#[derive(Debug, Clone)]
pub enum ReportCommand {
    /// Asks for a place to save at, in a window.
    AskSave(ReportFormat),
    /// Asks for it with a file dialog.
    Browse(ReportFormat),
    /// Does not save.
    Cancel,
    /// Saves at a place; the end of its name says in which format.
    Save(PathBuf),
}

/// A report that is to be saved.
#[derive(Debug, Clone)]
pub struct ReportDraft {
    /// How.
    pub format: ReportFormat,
    /// Where, as it is typed.
    pub path: String,
    /// What of it is wanted, and its head.
    pub choice: ReportChoice,
}

/// What a task with the report came to.
#[derive(Debug)]
pub enum ReportOutcome {
    /// The dialog was closed.
    Picked(Option<PathBuf>),
    /// The report was written.
    Saved {
        /// Its file.
        path: PathBuf,
        /// Nothing, or one sentence.
        result: Result<(), String>,
        /// Why it has no picture of the robot, if so.
        lack: Option<String>,
    },
}

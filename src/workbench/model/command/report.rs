//! Writing the report.

use std::collections::BTreeSet;
use std::path::PathBuf;

use crate::model::save_form::SaveForm;
use tautline_workflow::report::{ReportChoice, ReportFormat};

/// Saves the report of the session.
#[derive(Debug, Clone)]
pub enum ReportCommand {
    /// Asks for a place to save at, in a window.
    AskSave(ReportFormat),
    /// Asks for it with a file dialog.
    Browse(ReportFormat),
    /// Puts the place that was picked into the dialog.
    SetPath(PathBuf),
    Cancel,
    /// Saves to a path; its extension is the format.
    Save(PathBuf),
}

/// A report that is to be saved.
#[derive(Debug, Clone)]
pub struct ReportDraft {
    pub format: ReportFormat,
    pub form: SaveForm,
    /// Sections and heading of the report.
    pub choice: ReportChoice,
    /// Pulleys whose coordinates the picture of the robot shows.
    pub pinned: BTreeSet<usize>,
}

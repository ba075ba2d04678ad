//! Writing the report.

use std::collections::BTreeSet;
use std::path::PathBuf;

use tautline_session::{CalibratedInstrument, CertificateDetails};

use crate::model::save_form::SaveForm;
use tautline_workflow::report::{ReportChoice, ReportFormat};

/// Saves the report of the session.
#[derive(Debug, Clone)]
pub enum ReportCommand {
    /// Opens the dialog that saves the report.
    AskSave(ReportFormat),
    /// Asks for the path in a file dialog.
    Browse(ReportFormat),
    /// Puts the chosen path into the dialog.
    SetPath(PathBuf),
    Cancel,
    /// Saves to a path; its extension is the format.
    Save(PathBuf),
}

/// Report to be saved.
#[derive(Debug, Clone)]
pub struct ReportDraft {
    pub format: ReportFormat,
    pub form: SaveForm,
    /// Sections and heading of the report.
    pub choice: ReportChoice,
    /// Pulleys whose coordinates the picture of the robot shows.
    pub pinned: BTreeSet<usize>,
    /// Statements of the certificate besides the results; `instruments` lists those that can be chosen.
    pub details: CertificateDetails,
    /// Instruments of the workshop and of the session.
    pub instruments: Vec<WorkshopInstrument>,
}

impl ReportDraft {
    /// Details with only the instruments that were used.
    pub fn chosen_details(&self) -> CertificateDetails {
        let used = self.instruments.iter().filter(|one| one.is_used);
        CertificateDetails {
            instruments: used.map(|one| one.instrument.clone()).collect(),
            ..self.details.clone()
        }
    }
}

/// Instrument that a session can choose.
#[derive(Debug, Clone, PartialEq)]
pub struct WorkshopInstrument {
    pub instrument: CalibratedInstrument,
    /// Whether it was used for this session.
    pub is_used: bool,
    /// Whether its fields are visible.
    pub is_edited: bool,
}

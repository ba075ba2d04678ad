//! Writing the report.

use std::collections::BTreeSet;
use std::path::PathBuf;

use tautline_session::{CalibratedInstrument, CertificateDetails};

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
    /// What the certificate states beside the results; its instruments are those that are used.
    pub details: CertificateDetails,
    /// Instruments of the workshop and of the session.
    pub instruments: Vec<WorkshopInstrument>,
}

impl ReportDraft {
    /// The details with the instruments that are used.
    pub fn chosen_details(&self) -> CertificateDetails {
        let used = self.instruments.iter().filter(|one| one.is_used);
        CertificateDetails {
            instruments: used.map(|one| one.instrument.clone()).collect(),
            ..self.details.clone()
        }
    }
}

/// An instrument that a session can choose.
#[derive(Debug, Clone, PartialEq)]
pub struct WorkshopInstrument {
    pub instrument: CalibratedInstrument,
    /// Whether it was used for this session.
    pub is_used: bool,
    /// Whether its fields are shown.
    pub is_edited: bool,
}

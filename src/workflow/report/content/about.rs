//! Provenance of the report, and the log of the session.

use tautline_session::{Phase, Session, schemas};

use super::when;
use crate::audit;
use crate::report::document::{Section, Table};
use crate::report::input::ReportInput;
use crate::wording::{PROGRAM, list};

pub fn section(input: &ReportInput<'_>) -> Section {
    let mut section = Section::new("About this report");
    let formats: Vec<String> = schemas()
        .iter()
        .map(|schema| schema.file_name.trim_end_matches(".schema.json").to_owned())
        .collect();
    let facts = [
        ("Program", PROGRAM.to_owned()),
        ("File formats", list(&formats)),
        ("Created", when(input.now)),
        ("Session", input.session.name.clone()),
        ("Fingerprint of the inputs", input.session.basis()),
        ("Audit trail", audit::state(input.session)),
    ];
    let facts = facts.map(|(name, value)| (name.to_owned(), value));
    section.facts(facts);
    section
}

/// All steps of the operator.
pub fn log(session: &Session) -> Option<Section> {
    if session.log().is_empty() {
        return None;
    }
    let mut section = Section::new("Log of the session");
    let table = Table::of("Steps of the operator, the oldest first", 3, session.log());
    section.table(table.columns(&[
        ("Time", &|entry| when(entry.time).replace(' ', "\u{a0}")),
        ("Part", &|entry| phase(entry.phase).to_owned()),
        ("Step", &|entry| entry.text.clone()),
    ]));
    Some(section)
}

fn phase(phase: Phase) -> &'static str {
    match phase {
        Phase::Instruments => "Instruments",
        Phase::Cables => "Robot",
        Phase::Poses => "Measuring",
        Phase::Identification => "Identification",
        Phase::Diagnosis => "Diagnosis",
        Phase::Controller => "Controller",
        Phase::Accuracy => "Accuracy",
        Phase::Session => "Session",
    }
}

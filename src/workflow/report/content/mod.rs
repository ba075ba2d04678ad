//! The content of a report, part by part: sentences for the technician first, then figures for the engineer.

mod about;
mod accuracy;
mod adjustments;
mod budget;
mod causes;
pub mod certificate;
pub mod comparison;
pub mod conformity;
mod data;
mod displacements;
mod fit;
mod geometry;
pub mod history;
mod instruments;
mod limits;
mod method;
mod result;
mod robot;

use super::choice::{Part, ReportChoice};
use super::document::{Block, Document, Section};
use super::input::ReportInput;
use tautline_session::Timestamp;

use crate::wording::local_time::with_offset as when;
use crate::wording::units::{fixed as number, signed};

/// Placeholder of a missing number.
const NONE: &str = "–";

/// Marking of a report on a robot that does not exist, so that no page of it is taken for a certificate of a machine.
const SIMULATED: &str = "SIMULATED DATA";

/// The marking of a document.
fn marking(is_simulated: bool) -> &'static str {
    if is_simulated { SIMULATED } else { "" }
}

/// A document about several sessions: the heading as it was chosen, and the sections that have content.
fn titled(
    choice: &ReportChoice,
    title: String,
    (now, is_simulated): (Timestamp, bool),
    sections: impl IntoIterator<Item = Section>,
) -> Document {
    let people = [("Company", &choice.company), ("Operator", &choice.operator)];
    let people = people.map(|(what, who)| (what, who.trim()));
    let stated = people.iter().filter(|(_, who)| !who.is_empty());
    let stated = stated.map(|(what, who)| format!("{what}: {who}"));
    let created = format!("Created {}", when(now));
    let sections = sections.into_iter();
    Document {
        marking: marking(is_simulated),
        reference: String::new(),
        header: choice.header.trim().to_owned(),
        title: match choice.title.trim() {
            "" => title,
            chosen => chosen.to_owned(),
        },
        subtitle: stated.chain([created]).collect(),
        sections: sections
            .filter(|section| !section.blocks.is_empty())
            .collect(),
    }
}

/// Lines to sign on: who did what the report is about, and who approves it.
fn signatures(choice: &ReportChoice, done: &str, is_simulated: bool) -> Section {
    let mut section = Section::new("Signatures");
    if is_simulated {
        section.lead(format!(
            "{SIMULATED}: these readings are of a simulated robot, not of a machine."
        ));
    }
    let operator = choice.operator.trim();
    section.blocks.push(Block::Signatures(vec![
        (done.to_owned(), operator.to_owned()),
        ("Approved by".to_owned(), String::new()),
    ]));
    section
}

/// The whole content.
pub fn document(input: &ReportInput<'_>) -> Document {
    let choice = input.choice;
    let wanted = Part::ALL.into_iter().filter(|part| choice.has(*part));
    let reference = certificate::reference(input.session);
    let title = match (choice.title.trim(), reference.as_str()) {
        ("", "") => format!("Calibration report: {}", input.session.name),
        ("", reference) => reference.to_owned(),
        (title, _) => title.to_owned(),
    };
    let mut sections: Vec<Section> = wanted.filter_map(|part| section(part, input)).collect();
    if let Some(last) = sections.last_mut() {
        last.note(certificate::END);
    }
    Document {
        marking: marking(input.session.is_simulated()),
        reference,
        header: choice.header.trim().to_owned(),
        title,
        subtitle: head(input),
        sections,
    }
}

/// A part; `None` where the session has nothing for it.
fn section(part: Part, input: &ReportInput<'_>) -> Option<Section> {
    let session = input.session;
    match part {
        Part::Result => Some(result::section(input)),
        Part::Robot => Some(robot::section(&session.robot)),
        Part::Instruments => Some(instruments::section(session, input.now)),
        Part::Data => Some(data::section(session)),
        Part::Method => Some(method::section(session, input.fit?)),
        Part::Geometry => geometry::section(input),
        Part::Budget => budget::section(input.fit?, input.monte_carlo),
        Part::Conformity => conformity::section(input),
        Part::Fit => Some(fit::section(input.fit?, input.current_diagnosis())),
        Part::Causes => Some(causes::section(input, input.diagnosis?)),
        Part::Accuracy => accuracy::section(session),
        Part::Adjustments => adjustments::section(session),
        Part::Limits => Some(limits::section(input)),
        Part::Signatures => Some(instruments::signatures(input)),
        Part::About => Some(about::section(input)),
        Part::Deviations => geometry::deviations(input.fit?),
        Part::Log => about::log(session),
    }
}

/// The lines below the title.
fn head(input: &ReportInput<'_>) -> Vec<String> {
    let mut lines = certificate::head(input);
    for (what, who) in [
        ("Company", &input.choice.company),
        ("Operator", &input.choice.operator),
    ] {
        if !who.trim().is_empty() {
            lines.push(format!("{what}: {}", who.trim()));
        }
    }
    lines.push(format!("Created {}", when(input.now)));
    lines
}

//! The report of a study: sentences that answer, pictures, tables.

mod answers;
mod group;
mod pictures;
mod tables;

use std::path::Path;

use tautline_session::Timestamp;
use tautline_workflow::report::document::{Block, Document, Section};
use tautline_workflow::report::{ReportError, ReportFormat, render, write_document};

use crate::plan::StudyPlan;
use crate::result::StudyResult;
pub use answers::sentences;
pub use group::{Group, groups};

/// Maximum number of groups of cells that are plotted.
const DRAWN: usize = 8;

/// Writes the report as HTML or PDF, depending on the extension of the file.
///
/// # Errors
/// If the extension is another or the file cannot be written.
pub fn write_report(
    path: &Path,
    plan: &StudyPlan,
    result: &StudyResult,
    now: Timestamp,
) -> Result<(), ReportError> {
    write_document(path, &document(plan, result, now), now)
}

/// Renders the report as the bytes of a file.
///
/// # Errors
/// If the PDF cannot be created.
pub fn render_report(
    plan: &StudyPlan,
    result: &StudyResult,
    now: Timestamp,
    format: ReportFormat,
) -> Result<Vec<u8>, ReportError> {
    render(&document(plan, result, now), format, now)
}

fn document(plan: &StudyPlan, result: &StudyResult, now: Timestamp) -> Document {
    let groups = groups(plan, result);
    let sections = [
        answer(plan, result),
        accuracy(&groups),
        faults(plan, result, &groups),
        cost(&groups),
        check(plan, result),
        tables::cells(plan, result),
        about(plan, result, now),
    ];
    Document {
        title: format!("Study: {}", plan.study.name),
        subtitle: vec![format!("Created {now}")],
        sections: sections
            .into_iter()
            .filter(|section| !section.blocks.is_empty())
            .collect(),
        ..Document::default()
    }
}

fn answer(plan: &StudyPlan, result: &StudyResult) -> Section {
    let mut section = Section::new("Answers");
    section.list(sentences(plan, result));
    section
}

fn accuracy(groups: &[Group<'_>]) -> Section {
    let mut section = Section::new("Accuracy");
    section.note("Root mean square position error over the workspace once the identified values are in the controller. Lines: expected covariance. Points: simulation, with the range that contains 90 % of the calibrations. Standard deviations are 1 sd.");
    for group in groups.iter().take(DRAWN) {
        let plots: Vec<_> = [pictures::over_laser(group), pictures::over_poses(group)]
            .into_iter()
            .flatten()
            .collect();
        if !plots.is_empty() {
            section.heading(group.title.clone());
            section.blocks.push(Block::Plots(plots));
        }
    }
    section
        .blocks
        .extend(pictures::over_size(groups).map(|plot| Block::Plots(vec![plot])));
    if groups.len() > DRAWN {
        section.note(format!(
            "{} more groups of cells are listed in the table only.",
            groups.len() - DRAWN
        ));
    }
    section
}

fn faults(plan: &StudyPlan, result: &StudyResult, groups: &[Group<'_>]) -> Section {
    let mut section = Section::new("Faults");
    if plan.study.faults.is_empty() {
        return section;
    }
    section.paragraph(format!(
        "Detected: the global chi-square test rejects at {} %. Named: the diagnosis names the right fault, alone or among alternatives, and no wrong one.",
        100.0 * plan.study.simulation.alpha
    ));
    let plots: Vec<_> = groups
        .iter()
        .take(DRAWN)
        .filter_map(pictures::detection)
        .collect();
    if !plots.is_empty() {
        section.blocks.push(Block::Plots(plots));
    }
    section.table(tables::faults(plan, result));
    section
}

fn cost(groups: &[Group<'_>]) -> Section {
    let mut section = Section::new("Cost");
    let plots: Vec<_> = groups
        .iter()
        .take(DRAWN)
        .filter_map(pictures::over_cost)
        .collect();
    if !plots.is_empty() {
        section.blocks.push(Block::Plots(plots));
    }
    section
}

fn check(plan: &StudyPlan, result: &StudyResult) -> Section {
    let mut section = Section::new("Theory and simulation");
    let ratios: Vec<[f64; 3]> = (result.cells.iter())
        .filter_map(|cell| cell.simulated.as_ref()?.over_expected)
        .collect();
    let simulated = result
        .cells
        .iter()
        .filter(|cell| cell.simulated.is_some())
        .count();
    section.paragraph(format!(
        "{} of {} cells were simulated, {} calibrations in all; the others are predicted by the expected covariance.",
        simulated,
        result.cells.len(),
        result.calibrations
    ));
    if ratios.is_empty() {
        return section;
    }
    let least = ratios
        .iter()
        .map(|ratio| ratio[0])
        .fold(f64::INFINITY, f64::min);
    let largest = ratios.iter().map(|ratio| ratio[0]).fold(0.0, f64::max);
    let covering = ratios
        .iter()
        .filter(|ratio| ratio[1] <= 1.0 && ratio[2] >= 1.0)
        .count();
    section.paragraph(format!(
        "Simulated over expected position error: {least:.3} to {largest:.3}; {covering} of {} 95 % intervals contain 1.",
        ratios.len()
    ));
    let marked = tables::marked(plan, result);
    match marked.rows.is_empty() {
        true => section.paragraph("No cell differs by more than 5 %."),
        false => section.table(marked),
    }
    section
}

fn about(plan: &StudyPlan, result: &StudyResult, now: Timestamp) -> Section {
    let mut section = Section::new("About this study");
    let facts = [
        ("Program", format!("Tautline {}", result.program_version)),
        ("Created", now.to_string()),
        ("Fingerprint of the study", result.study.clone()),
        ("Seed", plan.study.seed.to_string()),
        (
            "Robots",
            plan.robots
                .iter()
                .map(|robot| robot.name.as_str())
                .collect::<Vec<_>>()
                .join(", "),
        ),
    ];
    section.blocks.push(Block::Facts(
        facts.map(|(name, value)| (name.to_owned(), value)).into(),
    ));
    section
}

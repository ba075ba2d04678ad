//! Content of the report of the record of a robot.

use super::{NONE, signatures, titled, when};
use crate::history::{Tolerance, changes, date, lane, next_calibration, rows};
use crate::report::document::{Block, Document, Section, Table};
use crate::report::input::HistoryInput;
use crate::report::plots;
use crate::wording::PROGRAM;
use crate::wording::units::{mm, quantity};

/// The whole content.
pub fn document(input: &HistoryInput<'_>) -> Document {
    let title = format!("History of {}", input.record.robot().label());
    let mut recorded = input.record.sessions.iter();
    let is_simulated = recorded.any(|session| session.is_simulated);
    let sections = [
        result(input),
        sessions(input),
        courses(input),
        signatures(input.choice, "Assessed by", is_simulated),
        about(input),
    ];
    titled(input.choice, title, (input.now, is_simulated), sections)
}

fn result(input: &HistoryInput<'_>) -> Section {
    let mut section = Section::new("Result");
    section.lead(format!("{}.", input.record.title()));
    section.list(changes(input.record, input.found));
    if let Some(due) = next_calibration(input.record, input.found) {
        section.paragraph(due);
    }
    for notice in &input.record.notices {
        section.note(notice);
    }
    section
}

fn sessions(input: &HistoryInput<'_>) -> Section {
    let mut section = Section::new("Sessions");
    let caption = "Standard deviations and moves are the largest of all pulleys, with all sessions taken into account";
    let millimetres = |value: Option<f64>| value.map_or_else(|| NONE.to_owned(), |m| mm(m, 2));
    let table = Table::of(caption, 3, rows(input.record, input.found));
    section.table(table.columns(&[
        ("Session", &|row| row.name.clone()),
        ("measured", &|row| {
            row.time.map_or_else(|| NONE.to_owned(), date)
        }),
        ("operator", &|row| row.operator.clone().unwrap_or_default()),
        ("poses", &|row| row.poses.to_string()),
        ("standard deviation mm", &|row| mm(row.largest_sd_m, 2)),
        ("move since before mm", &|row| {
            millimetres(row.largest_move_m)
        }),
        ("accuracy after mm", &|row| {
            millimetres(row.accuracy_after_m)
        }),
    ]));
    section
}

fn courses(input: &HistoryInput<'_>) -> Section {
    let mut section = Section::new("Over time");
    let tolerance = match input.found.tolerance {
        Tolerance::Pulley(limit_m) => format!("; the tolerance is {}", quantity(limit_m, "m")),
        Tolerance::Position { .. } => String::new(),
    };
    section.note(format!(
        "Coordinates less those of the last session: lines with 95 % bands by all sessions together, points by each session itself{tolerance}. A shaded range of dates is one in which a jump \
         happened; dashed lines are events."
    ));
    let parts = 0..input.found.history.parts.len();
    let drawn = parts.map(|part| plots::course(&lane(input.record, input.found, part)));
    section.blocks.push(Block::Plots(drawn.collect()));
    section
}

fn about(input: &HistoryInput<'_>) -> Section {
    let mut section = Section::new("About this report");
    let facts = [
        ("Program", PROGRAM.to_owned()),
        ("Created", when(input.now)),
    ];
    section.facts(facts.map(|(name, value)| (name.to_owned(), value)));
    section
}

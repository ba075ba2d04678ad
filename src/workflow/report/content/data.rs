//! The measured data.

use tautline_core::measurement::{Grid, Measurements};
use tautline_session::Session;

use super::when;
use crate::foreign_writes::sentences;
use crate::report::document::{Section, Table};
use crate::wording::list;

pub fn section(session: &Session) -> Section {
    let mut section = Section::new("Data");
    let measured = &session.measurements;
    let mut facts = Vec::new();
    let mut add = |name: &str, value: String| facts.push((name.to_owned(), value));
    add("Session created", when(session.created));
    add("Last modified", when(session.modified));
    add("Poses measured", poses(measured));
    add("Excluded", left_out(session));
    if let Some(duration) = duration(measured) {
        add("Duration", duration);
    }
    if let Some(range) = range(&measured.temperature_c) {
        add(
            "Temperature",
            format!("{:.1} to {:.1} °C", range[0], range[1]),
        );
    }
    add("Tables of phases 1 and 2", phases(session));
    section.facts(facts);
    for text in sentences(session) {
        section.paragraph(text);
    }
    section.table(readings(measured, session.phases.distances.len()));
    section
}

fn poses(measured: &Measurements) -> String {
    match (measured.len(), measured.home_row()) {
        (0, _) => "none".to_owned(),
        (all, Some(_)) => format!("{} and the home pose", all - 1),
        (all, None) => all.to_string(),
    }
}

fn left_out(session: &Session) -> String {
    let labels: Vec<String> = session.excluded().iter().map(i64::to_string).collect();
    match labels.len() {
        0 => "no pose".to_owned(),
        1 => format!("pose {}", labels.concat()),
        _ => format!("poses {}", list(&labels)),
    }
}

/// Smallest and largest of the measured values.
fn range(values: &[f64]) -> Option<[f64; 2]> {
    let finite = || values.iter().copied().filter(|v| v.is_finite());
    let least = finite().reduce(f64::min)?;
    Some([least, finite().reduce(f64::max)?])
}

fn duration(measured: &Measurements) -> Option<String> {
    let [first, last] = range(&measured.time_s)?;
    let minutes = ((last - first) / 60.0).round();
    Some(if minutes < 60.0 {
        format!("{minutes:.0} min")
    } else {
        format!(
            "{:.0} h {:.0} min",
            (minutes / 60.0).floor(),
            minutes % 60.0
        )
    })
}

fn phases(session: &Session) -> String {
    let phases = &session.phases;
    let tables = [
        ("winches", phases.winch.len()),
        ("force sensors", phases.force.len()),
        ("home platform", phases.home.len()),
        ("elongation", phases.elongation.len()),
    ];
    let present = tables.iter().filter(|(_, rows)| *rows > 0);
    let present: Vec<String> = present
        .map(|(name, rows)| format!("{name} ({rows} rows)"))
        .collect();
    if present.is_empty() {
        "none: nominal values are used".to_owned()
    } else {
        list(&present)
    }
}

fn readings(measured: &Measurements, distances: usize) -> Table {
    let mut table = Table::new(
        "Readings, those of excluded poses included",
        1,
        &["Reading", "number"],
    );
    let grid = |grid: &Grid| {
        (0..grid.rows())
            .flat_map(|r| grid.row(r))
            .filter(|v| v.is_finite())
            .count()
    };
    let rows = |rows: &[[f64; 3]]| {
        rows.iter()
            .filter(|r| r.iter().all(|v| v.is_finite()))
            .count()
    };
    let tracked = measured.tracked_orientation_wxyz.iter();
    for (name, number) in [
        ("Motor revolutions", grid(&measured.revolutions)),
        ("Absolute lengths", grid(&measured.length_m)),
        ("Tensions", grid(&measured.force_n)),
        (
            "Laser distances",
            measured.laser_m.iter().filter(|v| v.is_finite()).count(),
        ),
        ("Swivel angles", grid(&measured.swivel_rad)),
        (
            "Inclinations (roll, pitch, yaw)",
            rows(&measured.inclination_rad),
        ),
        (
            "Positions by the external instrument",
            rows(&measured.tracked_position_m),
        ),
        (
            "Orientations by the external instrument",
            tracked.filter(|q| q.iter().all(|v| v.is_finite())).count(),
        ),
        ("Distances between poses", distances),
    ] {
        if number > 0 {
            table.push([name.to_owned(), number.to_string()]);
        }
    }
    table
}

//! Layout of a table: where its data begin, and the headings of its columns.

use std::collections::HashMap;

use tautline_files::{Location, ReadError};

use crate::text::{Cells, Separator, is_gap, parse_number, parse_timestamp};
use crate::units::{are_units, bare, split_heading};

/// Layout of a table.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Layout {
    /// Name and unit of each column.
    pub headings: Vec<(String, Option<String>)>,
    /// Whether the file has a header row.
    pub has_header: bool,
    /// Line of the first row of data.
    pub first_data_line: u64,
    /// Lines before the header row that are not part of the table.
    preamble: Vec<(u64, String)>,
    /// Line and number of cells of the first row of another table before this one.
    other_table: Option<(u64, usize)>,
}

impl Layout {
    /// The separator that yields the most numeric cells.
    pub fn separator(lines: &[(u64, &str)]) -> Separator {
        let score = |separator: &Separator| {
            let split: Vec<Cells> = lines
                .iter()
                .map(|(_, line)| Cells::of(line, *separator))
                .collect();
            let width = width(split.iter());
            let cells = split
                .iter()
                .filter(|cells| cells.len() == width && is_data(cells));
            let counts = cells.map(|cells| {
                let numbers = cells.iter().filter(|cell| is_reading(cell)).count() as i64;
                let texts = cells
                    .iter()
                    .filter(|cell| !is_gap(cell) && !is_reading(cell))
                    .count() as i64;
                numbers - texts
            });
            counts.sum::<i64>()
        };
        let mut best = (Separator::ALL[0], 0);
        for separator in Separator::ALL {
            let score = score(&separator);
            if score > best.1 {
                best = (separator, score);
            }
        }
        best.0
    }

    /// The layout of a table that begins with these rows; `None` if there is no row of data.
    pub fn of(rows: &[(u64, &Cells)]) -> Option<Self> {
        let width = width(
            rows.iter()
                .map(|(_, cells)| *cells)
                .filter(|cells| is_data(cells)),
        );
        let is_row = |(_, cells): &(u64, &Cells)| is_data(cells) && cells.len() == width;
        let first = rows.iter().position(is_row)?;
        let before: Vec<&(u64, &Cells)> = rows[..first]
            .iter()
            .filter(|(_, cells)| !cells.are_blank())
            .collect();
        let fits = |cells: &Cells| {
            cells.len() == width || cells.len() + 1 == width || is_commented(cells, width)
        };
        let mut header = before.len();
        let mut units = None;
        if let Some((_, cells)) = before.last()
            && fits(cells)
            && are_units(cells.iter().filter(|cell| !matches!(*cell, "#" | "%")))
            && before.len() > 1
        {
            units = Some(named(cells, width));
            header -= 1;
        }
        let names = before[..header]
            .last()
            .filter(|(_, cells)| fits(cells))
            .map(|(_, cells)| named(cells, width));
        let has_header = names.is_some();
        let preamble = &before[..header - usize::from(has_header)];
        let others: Vec<&&(u64, &Cells)> = preamble
            .iter()
            .filter(|(_, cells)| is_data(cells) && cells.len() > 1 && !is_setting(cells))
            .collect();
        let joined = |cells: &Cells| cells.iter().collect::<Vec<_>>().join(" ").trim().to_owned();
        let mut headings: Vec<(String, Option<String>)> = (0..width)
            .map(|k| {
                let name = names.as_ref().map_or("", |names| names[k].as_str());
                let (name, unit) = split_heading(name);
                let stated = units.as_ref().map(|units| bare(&units[k]).to_owned());
                let stated = stated.filter(|unit| !unit.is_empty());
                (name, stated.or(unit))
            })
            .collect();
        if !has_header {
            name_points(&mut headings, rows[first].1);
        }
        make_unique(headings.iter_mut().map(|(name, _)| name));
        Some(Self {
            headings,
            has_header,
            other_table: others
                .first()
                .filter(|_| others.len() > 1)
                .map(|(line, cells)| (*line, cells.len())),
            first_data_line: rows[first].0,
            preamble: preamble
                .iter()
                .map(|(line, cells)| (*line, joined(cells)))
                .collect(),
        })
    }

    /// Whether the table is a list of points, each with a name and coordinates.
    pub fn is_point_list(&self) -> bool {
        !self.has_header && self.headings[0].0 == "name"
    }

    /// Refuses a file of two tables: one of them would be dropped.
    ///
    /// # Errors
    /// If several rows before the table have readings but a different number of cells.
    pub fn check(&self, file: &str) -> Result<(), ReadError> {
        let Some((line, found)) = self.other_table else {
            return Ok(());
        };
        let message = format!(
            "found {found} cells, expected {} as in most rows",
            self.headings.len()
        );
        Err(ReadError::new(file, Location::Line(line), message))
    }

    /// Sentences about lines that are not part of the table.
    pub fn notices(&self, file: &str) -> Vec<String> {
        let Some((line, text)) = self.preamble.first() else {
            return Vec::new();
        };
        let text: String = text.chars().take(40).collect();
        let rest = match self.preamble.len() {
            1 => String::new(),
            count => format!(" and {} more lines", count - 1),
        };
        vec![format!(
            "{file}, line {line}: \"{text}\"{rest} before the table: not used"
        )]
    }
}

/// The most frequent number of cells.
fn width<'a>(rows: impl Iterator<Item = &'a Cells>) -> usize {
    let mut counts: HashMap<usize, usize> = HashMap::new();
    for cells in rows.filter(|cells| !cells.are_blank()) {
        *counts.entry(cells.len()).or_default() += 1;
    }
    counts
        .into_iter()
        .max_by_key(|(width, count)| (*count, *width))
        .map_or(0, |(width, _)| width)
}

/// A number or a time.
fn is_reading(cell: &str) -> bool {
    parse_number(cell).is_some() || parse_timestamp(cell).is_some()
}

/// Whether a row is data: at least half of its filled cells are readings.
fn is_data(cells: &Cells) -> bool {
    let readings = cells.iter().filter(|cell| is_reading(cell)).count();
    let filled = cells.iter().filter(|cell| !is_gap(cell)).count();
    readings > 0 && readings * 2 >= filled
}

/// Whether a row is a setting of the recorder: a key, its value and perhaps a unit, such as `Abtastrate;1000`.
fn is_setting(cells: &Cells) -> bool {
    let filled = cells.iter().filter(|cell| !is_gap(cell)).count();
    !is_gap(cells.get(0)) && !is_reading(cells.get(0)) && filled <= 3
}

/// Whether a header row begins with a comment sign.
fn is_commented(cells: &Cells, width: usize) -> bool {
    matches!(cells.get(0), "#" | "%") && cells.len() == width + 1
}

/// The cells of a header row, as many as there are columns.
fn named(cells: &Cells, width: usize) -> Vec<String> {
    let skipped = usize::from(is_commented(cells, width));
    let names = (0..width).map(|k| cells.get(k + skipped));
    names
        .map(|name| name.trim_start_matches(['#', '%']).trim().to_owned())
        .collect()
}

/// Names for the columns of a table without a header: those of a point list, or their numbers.
fn name_points(headings: &mut [(String, Option<String>)], row: &Cells) {
    const POINT: [&str; 7] = ["name", "x", "y", "z", "sx", "sy", "sz"];
    let is_text = |k: usize| !is_reading(row.get(k));
    let is_point =
        matches!(headings.len(), 4 | 7) && is_text(0) && (1..headings.len()).all(|k| !is_text(k));
    for (k, (name, _)) in headings.iter_mut().enumerate() {
        *name = if is_point {
            POINT[k].into()
        } else {
            format!("column {}", k + 1)
        };
    }
}

/// Numbers unnamed columns and repeated names.
pub(crate) fn make_unique<'a>(names: impl Iterator<Item = &'a mut String>) {
    let mut seen: HashMap<String, usize> = HashMap::new();
    for (k, name) in names.enumerate() {
        if name.is_empty() {
            *name = format!("column {}", k + 1);
        }
        let count = seen.entry(name.clone()).or_default();
        *count += 1;
        if *count > 1 {
            *name = format!("{name} ({count})");
        }
    }
}

//! Excel workbooks (`.xlsx`): a zip archive of XML, one part for each sheet.
//!
//! Cell values, shared texts and the number formats of dates are read here. Source: ECMA-376, part 1, chapter 18.

use quick_xml::Reader;
use quick_xml::events::Event;
use tautline_files::ReadError;

use super::fault::Fault;
use super::workbook::{Grid, Workbook};
use super::workbook_xml::{add_text, attribute, for_each_tag};
use crate::memory::MemoryBudget;
use crate::source::{Format, Source};

/// The part with the list of the sheets.
pub(super) const WORKBOOK: &str = "xl/workbook.xml";
/// Memory of a shared text besides its letters, which the part has, too.
const TEXT: u64 = size_of::<String>() as u64;

pub(super) fn read(archive: &Workbook<'_>) -> Result<Source, ReadError> {
    let workbook = archive.expected_part(WORKBOOK)?;
    let name = "xl/_rels/workbook.xml.rels";
    let targets = archive.part(name, archive.budget)?.unwrap_or_default();
    let targets = relations(&targets).ok_or_else(|| archive.damaged(name))?;
    let name = "xl/sharedStrings.xml";
    let shared = match archive.part(name, archive.budget)? {
        Some(text) => {
            shared_texts(&text, archive.budget).map_err(|fault| archive.refused(name, fault))?
        }
        None => Vec::new(),
    };
    let name = "xl/styles.xml";
    let dates = match archive.part(name, archive.budget)? {
        Some(text) => date_styles(&text).ok_or_else(|| archive.damaged(name))?,
        None => Vec::new(),
    };
    let sheets = sheets(&workbook).ok_or_else(|| archive.damaged(WORKBOOK))?;
    let mut found = archive.sheets(Format::Excel, sheets.len());
    for (name, relation) in &sheets {
        let target = targets
            .iter()
            .find(|(id, _)| id == relation)
            .map(|(_, target)| target.trim_start_matches('/'));
        let target = target.map(|target| {
            if target.starts_with("xl/") {
                target.to_owned()
            } else {
                format!("xl/{target}")
            }
        });
        let Some(target) = target else {
            return Err(archive.damaged(WORKBOOK));
        };
        // Of a sheet only its series is kept.
        let sheet = archive.budget.temporary();
        let Some(text) = archive.part(&target, &sheet)? else {
            found.leave_out(name);
            continue;
        };
        let rows = rows(&text, &shared, &dates, &sheet);
        let rows = rows.map_err(|fault| archive.refused(&target, fault))?;
        found.add(name, &target, rows)?;
    }
    found.finish()
}

/// Name and relation of each sheet.
fn sheets(text: &str) -> Option<Vec<(String, String)>> {
    let mut sheets = Vec::new();
    for_each_tag(text, |tag| {
        if tag.local_name().as_ref() == b"sheet" {
            // `sheetId` is another number; the relation is the attribute `id` in its own namespace.
            sheets.extend(attribute(tag, "name").zip(attribute(tag, "id")));
        }
    })?;
    Some(sheets)
}

/// Identifier and part of each relation.
fn relations(text: &str) -> Option<Vec<(String, String)>> {
    let mut relations = Vec::new();
    for_each_tag(text, |tag| {
        if tag.local_name().as_ref() == b"Relationship" {
            relations.extend(attribute(tag, "Id").zip(attribute(tag, "Target")));
        }
    })?;
    Some(relations)
}

/// For each cell style, whether it is a date or a time.
fn date_styles(text: &str) -> Option<Vec<bool>> {
    let (mut own, mut styles, mut in_cells) = (Vec::new(), Vec::new(), false);
    for_each_tag(text, |tag| match tag.local_name().as_ref() {
        b"numFmt" => {
            let code = attribute(tag, "formatCode")
                .unwrap_or_default()
                .to_lowercase();
            let code: String = code.split('"').step_by(2).collect();
            if code.contains(['y', 'd', 'h']) || code.contains("ss") {
                own.extend(attribute(tag, "numFmtId"));
            }
        }
        b"cellXfs" => in_cells = true,
        b"cellStyles" => in_cells = false,
        b"xf" if in_cells => {
            let id = attribute(tag, "numFmtId").unwrap_or_default();
            let number: u32 = id.parse().unwrap_or_default();
            styles.push(matches!(number, 14..=22 | 45..=47) || own.contains(&id));
        }
        _ => {}
    })?;
    Some(styles)
}

/// The texts to which cells refer by number. Their memory is counted, since an empty one takes more than its tag.
fn shared_texts(text: &str, budget: &MemoryBudget) -> Result<Vec<String>, Fault> {
    let mut reader = Reader::from_str(text);
    let (mut texts, mut current, mut in_text, mut phonetic) =
        (Vec::new(), String::new(), false, false);
    loop {
        match reader.read_event().map_err(|_| Fault::Damaged)? {
            Event::Start(tag) => match tag.local_name().as_ref() {
                b"si" => current.clear(),
                b"t" => in_text = !phonetic,
                b"rPh" => phonetic = true,
                _ => {}
            },
            Event::Empty(tag) if tag.local_name().as_ref() == b"si" => {
                budget.take(TEXT)?;
                texts.push(String::new());
            }
            Event::End(tag) => match tag.local_name().as_ref() {
                b"si" => {
                    budget.take(TEXT)?;
                    texts.push(std::mem::take(&mut current));
                }
                b"t" => in_text = false,
                b"rPh" => phonetic = false,
                _ => {}
            },
            Event::Eof => return Ok(texts),
            event => add_text(&event, in_text, &mut current).ok_or(Fault::Damaged)?,
        }
    }
}

/// The rows of a sheet with their numbers; the cells that it leaves out are empty.
fn rows(
    text: &str,
    shared: &[String],
    dates: &[bool],
    budget: &MemoryBudget,
) -> Result<Grid, Fault> {
    let mut reader = Reader::from_str(text);
    let (mut grid, mut number) = (Grid::new(budget), 0_u64);
    let (mut kind, mut style, mut column, mut value, mut in_value) =
        (String::new(), 0_usize, 0_usize, String::new(), false);
    loop {
        match reader.read_event().map_err(|_| Fault::Damaged)? {
            Event::Start(tag) | Event::Empty(tag) if tag.local_name().as_ref() == b"row" => {
                number = attribute(&tag, "r")
                    .and_then(|number| number.parse().ok())
                    .unwrap_or(number + 1);
                grid.cells.clear();
            }
            Event::Start(tag) | Event::Empty(tag) if tag.local_name().as_ref() == b"c" => {
                kind = attribute(&tag, "t").unwrap_or_default();
                style = attribute(&tag, "s")
                    .and_then(|style| style.parse().ok())
                    .unwrap_or(0);
                let place = attribute(&tag, "r");
                let place = place.map_or(Some(grid.cells.len()), |place| column_of(&place));
                column = place.ok_or(Fault::Damaged)?;
                value.clear();
            }
            Event::Start(tag) if matches!(tag.local_name().as_ref(), b"v" | b"t") => {
                in_value = true;
            }
            Event::End(tag) => match tag.local_name().as_ref() {
                b"v" | b"t" => in_value = false,
                b"c" => {
                    let is_date = dates.get(style) == Some(&true);
                    let cell = shown(&kind, &value, is_date, shared).ok_or(Fault::Damaged)?;
                    grid.put(column, 1, cell)?;
                }
                b"row" => grid.end_row(number, 1)?,
                _ => {}
            },
            Event::Eof => break,
            event => add_text(&event, in_value, &mut value).ok_or(Fault::Damaged)?,
        }
    }
    Ok(grid)
}

/// The text of a cell. Dates are stored as days since 1900 and shown as date and time.
fn shown(kind: &str, value: &str, is_date: bool, shared: &[String]) -> Option<String> {
    match kind {
        "s" => shared.get(value.trim().parse::<usize>().ok()?).cloned(),
        "e" => Some(String::new()),
        "" | "n" if is_date && !value.is_empty() => {
            let days: f64 = value.parse().ok()?;
            let clock = (days.fract() * 86_400e3).round() / 1e3;
            let (hours, seconds) = ((clock / 3600.0).floor(), clock % 3600.0);
            let time = format!(
                "{:02}:{:02}:{:06.3}",
                hours,
                (seconds / 60.0).floor(),
                seconds % 60.0
            );
            Some(match days < 1.0 || hours >= 24.0 {
                true => time,
                false => format!("{} {time}", civil(days.floor() as i64 - 25_569)),
            })
        }
        _ => Some(value.to_owned()),
    }
}

/// `2024-05-31` of days since 1970.
fn civil(days: i64) -> String {
    let shifted = days + 719_468;
    let (era, of_era) = (shifted.div_euclid(146_097), shifted.rem_euclid(146_097));
    let year_of_era = (of_era - of_era / 1460 + of_era / 36_524 - of_era / 146_096) / 365;
    let of_year = of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let month = (5 * of_year + 2) / 153;
    let day = of_year - (153 * month + 2) / 5 + 1;
    let month = if month < 10 { month + 3 } else { month - 9 };
    let year = era * 400 + year_of_era + i64::from(month <= 2);
    format!("{year:04}-{month:02}-{day:02}")
}

/// Column index, from 0, of a reference such as `AB12`.
fn column_of(place: &str) -> Option<usize> {
    let letters = place.bytes().take_while(u8::is_ascii_uppercase);
    let column = letters.fold(0_usize, |column, letter| {
        column
            .saturating_mul(26)
            .saturating_add(usize::from(letter - b'A') + 1)
    });
    column.checked_sub(1)
}

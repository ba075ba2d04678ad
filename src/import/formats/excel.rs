//! Excel workbooks (`.xlsx`): a zip archive of XML, one part for each sheet.
//!
//! Cell values, shared texts and the number formats of dates are read here; the crates that read workbooks switch the whole
//! program to another compressor. Source: ECMA-376, part 1, chapter 18.

use quick_xml::events::{BytesStart, Event};
use quick_xml::{Reader, XmlVersion};
use tautline_session::{Place, ReadError, quoted};

use super::archive::Archive;
use super::fault::Fault;
use super::{over_budget, stem, whole};
use crate::input::Input;
use crate::memory::Lease;
use crate::source::{Format, Source};
use crate::table::read_rows;
use crate::text::Cells;

/// Maximum number of columns of a sheet, as in Excel.
const MAX_COLUMNS: usize = 16_384;
/// Maximum number of cells, including empty ones in between.
const MAX_CELLS: usize = 50_000_000;

pub(super) fn read(mut input: Input<'_>, file: &str) -> Result<Source, ReadError> {
    let fail = |message: String| ReadError::new(file, Place::File, message);
    let budget = input.budget();
    let lease = || budget.lease(0).map_err(|over| over_budget(file, over));
    let mut book = lease()?;
    let (bytes, _memory) = whole(&mut input, file)?;
    let archive = Archive::open(&bytes).map_err(fail)?;
    let part = |name: &str, memory: &mut Lease| -> Result<Option<String>, ReadError> {
        let Some(bytes) = archive.read(name, memory).map_err(fail)? else {
            return Ok(None);
        };
        let text = String::from_utf8(bytes)
            .map_err(|_| fail(format!("part {name} is damaged, expected UTF-8")))?;
        Ok(Some(text))
    };
    let Some(workbook) = part("xl/workbook.xml", &mut book)? else {
        return Err(fail(
            "is an archive without a workbook or arrays, expected .xlsx or .npz".into(),
        ));
    };
    let damaged = |name: &str| fail(format!("part {name} is damaged, expected XML"));
    let refused = |name: &str, fault: Fault| match fault {
        Fault::Damaged => damaged(name),
        Fault::Large(over) => fail(format!("part {name} {over}")),
    };
    let targets = relations(&part("xl/_rels/workbook.xml.rels", &mut book)?.unwrap_or_default())
        .ok_or_else(|| damaged("xl/_rels/workbook.xml.rels"))?;
    let name = "xl/sharedStrings.xml";
    let shared = match part(name, &mut book)? {
        Some(text) => shared_texts(&text, &mut book).map_err(|fault| refused(name, fault))?,
        None => Vec::new(),
    };
    let dates = match part("xl/styles.xml", &mut book)? {
        Some(text) => date_styles(&text).ok_or_else(|| damaged("xl/styles.xml"))?,
        None => Vec::new(),
    };
    let sheets = sheets(&workbook).ok_or_else(|| damaged("xl/workbook.xml"))?;
    let mut source = Source {
        file: file.into(),
        format: Format::Excel,
        series: Vec::new(),
        notices: Vec::new(),
    };
    let mut refusal = None;
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
            return Err(damaged("xl/workbook.xml"));
        };
        // Of a sheet only its series is kept.
        let mut sheet = lease()?;
        let Some(text) = part(&target, &mut sheet)? else {
            source.notices.push(format!(
                "{file}: sheet {} left out: it is not a table",
                quoted(name)
            ));
            continue;
        };
        let place = format!("{file}, sheet {}", quoted(name));
        let rows = rows(&text, &shared, &dates, &mut sheet);
        let rows = rows.map_err(|fault| refused(&target, fault))?;
        if rows.is_empty() {
            source.notices.push(format!("{place}: empty"));
            continue;
        }
        let title = if sheets.len() == 1 {
            stem(file)
        } else {
            format!("{} {name}", stem(file))
        };
        match read_rows(&place, &title, &rows, budget, &mut source.notices) {
            Ok(series) => source.series.push(series),
            // A sheet of notes beside the readings is no reason to refuse them.
            Err(error) => {
                source.notices.push(format!("{error}: sheet left out"));
                refusal.get_or_insert(error);
            }
        }
    }
    match (source.series.is_empty(), refusal) {
        (false, _) => Ok(source),
        (true, Some(refusal)) => Err(refusal),
        (true, None) => Err(fail("found empty sheets only, expected readings".into())),
    }
}

/// Memory of a cell besides its text: its string, and its range in the row.
const CELL: usize = size_of::<String>() + size_of::<(usize, usize)>();

/// Calls `visit` with each opening tag; `None` if the text is not XML.
fn for_each_tag(text: &str, mut visit: impl FnMut(&BytesStart<'_>)) -> Option<()> {
    let mut reader = Reader::from_str(text);
    loop {
        match reader.read_event().ok()? {
            Event::Start(tag) | Event::Empty(tag) => visit(&tag),
            Event::Eof => return Some(()),
            _ => {}
        }
    }
}

/// An attribute by its name without prefix.
fn attribute(tag: &BytesStart<'_>, name: &str) -> Option<String> {
    let found = tag
        .attributes()
        .flatten()
        .find(|attribute| attribute.key.local_name().as_ref() == name.as_bytes())?;
    found
        .normalized_value(XmlVersion::Implicit1_0)
        .ok()
        .map(|value| value.into_owned())
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

/// For each style of cells whether it is a date or a time.
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

/// The texts that cells refer to by number, whose memory is added to the lease.
fn shared_texts(text: &str, memory: &mut Lease) -> Result<Vec<String>, Fault> {
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
                memory.take_values::<String>(1)?;
                texts.push(String::new());
            }
            Event::End(tag) => match tag.local_name().as_ref() {
                b"si" => {
                    memory.take((size_of::<String>() + current.capacity()) as u64)?;
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

/// Appends what an event adds to a text.
fn add_text(event: &Event<'_>, wanted: bool, to: &mut String) -> Option<()> {
    match event {
        Event::Text(text) if wanted => to.push_str(&text.decode().ok()?),
        Event::CData(text) if wanted => to.push_str(&text.decode().ok()?),
        Event::GeneralRef(name) if wanted => match name.resolve_char_ref().ok()? {
            Some(letter) => to.push(letter),
            None => to.push_str(quick_xml::escape::resolve_xml_entity(&name.decode().ok()?)?),
        },
        _ => {}
    }
    Some(())
}

/// The rows of a sheet with their numbers; the cells that it leaves out are empty. Their memory is added to the lease.
fn rows(
    text: &str,
    shared: &[String],
    dates: &[bool],
    memory: &mut Lease,
) -> Result<Vec<(u64, Cells)>, Fault> {
    let mut reader = Reader::from_str(text);
    let mut rows = Vec::new();
    let (mut cells, mut number, mut total): (Vec<String>, u64, usize) = (Vec::new(), 0, 0);
    let (mut kind, mut style, mut column, mut value, mut in_value) =
        (String::new(), 0_usize, 0_usize, String::new(), false);
    loop {
        match reader.read_event().map_err(|_| Fault::Damaged)? {
            Event::Start(tag) | Event::Empty(tag) if tag.local_name().as_ref() == b"row" => {
                number = attribute(&tag, "r")
                    .and_then(|number| number.parse().ok())
                    .unwrap_or(number + 1);
                cells.clear();
            }
            Event::Start(tag) | Event::Empty(tag) if tag.local_name().as_ref() == b"c" => {
                kind = attribute(&tag, "t").unwrap_or_default();
                style = attribute(&tag, "s")
                    .and_then(|style| style.parse().ok())
                    .unwrap_or(0);
                let place = attribute(&tag, "r");
                let place = place.map_or(Some(cells.len()), |place| column_of(&place));
                column = place.ok_or(Fault::Damaged)?;
                value.clear();
            }
            Event::Start(tag) if matches!(tag.local_name().as_ref(), b"v" | b"t") => {
                in_value = true;
            }
            Event::End(tag) => match tag.local_name().as_ref() {
                b"v" | b"t" => in_value = false,
                b"c" => {
                    if column >= MAX_COLUMNS {
                        return Err(Fault::Damaged);
                    }
                    let is_date = dates.get(style) == Some(&true);
                    let cell = shown(&kind, &value, is_date, shared).ok_or(Fault::Damaged)?;
                    // The text is copied to that of the row.
                    let gap = (column + 1).saturating_sub(cells.len());
                    memory.take((gap * CELL + 2 * cell.len()) as u64)?;
                    cells.resize(cells.len().max(column + 1), String::new());
                    cells[column] = cell;
                }
                b"row" => {
                    total += cells.len();
                    if total > MAX_CELLS {
                        return Err(Fault::Damaged);
                    }
                    memory.take_values::<(u64, Cells)>(2)?;
                    rows.push((number, std::mem::take(&mut cells)));
                }
                _ => {}
            },
            Event::Eof => break,
            event => add_text(&event, in_value, &mut value).ok_or(Fault::Damaged)?,
        }
    }
    let width = rows.iter().map(|(_, cells)| cells.len()).max().unwrap_or(0);
    let filled = rows
        .into_iter()
        .filter(|(_, cells)| cells.iter().any(|cell| !cell.is_empty()));
    // Empty cells at the end of a row are not stored; titles may precede the table.
    let mut in_table = false;
    let padded = filled.map(|(number, mut cells)| {
        in_table |= cells.len() == width;
        if in_table {
            memory.take(((width - cells.len()) * CELL) as u64)?;
            cells.resize(width, String::new());
        }
        Ok((number, Cells::from_texts(&cells)))
    });
    padded.collect()
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

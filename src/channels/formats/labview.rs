//! Measurement files of LabVIEW (`.lvm`): a header, and segments of columns, each with a header of its own.
//!
//! Source: NI, "Specification for the LabVIEW Measurement File (.lvm)". `X_Columns` states whether the segments have no column of
//! times (then `X0` and `Delta_X` do), one, or one before each channel.

use tautline_files::{Location, ReadError, quoted};

use super::{encoding_notice, stem};
use crate::input::Input;
use crate::source::{Channel, Format, Series, Source};
use crate::table::make_unique;
use crate::text::{Cells, Lines, Separator, is_gap, parse_number};
use crate::units::split_heading;
use crate::values::Values;

const END_OF_HEADER: &str = "***End_of_Header***";
const START_SPECIAL: &str = "***Start_Special***";
const END_SPECIAL: &str = "***End_Special***";
/// Heading of a column of times.
const X_VALUE: &str = "X_Value";
const COMMENT: &str = "Comment";

/// Whether a line is the first one of a LabVIEW measurement file.
pub(super) fn is_title(line: &str) -> bool {
    line.trim_start_matches('"')
        .starts_with("LabVIEW Measurement")
}

pub(super) fn read(head: &[u8], input: Input<'_>, file: &str) -> Result<Source, ReadError> {
    let mut lines = Lines::new(head, input, file);
    let separator = match lines.look_ahead(1)?.front() {
        Some((_, text)) if text.contains(',') && !text.contains('\t') => ',',
        _ => '\t',
    };
    let separator = Separator::Character(separator);
    let title = header(&mut lines, separator)?;
    let has_times = title.value("X_Columns") != Some("No");
    let mut source = Source {
        file: file.into(),
        format: Format::LabView,
        series: Vec::new(),
        notices: Vec::new(),
    };
    let mut number = 0;
    while let Some(segment) = segment(&mut lines, separator)? {
        number += 1;
        let name = match number {
            1 => stem(file),
            _ => format!("{} {number}", stem(file)),
        };
        let series = segment.into_series(&name, has_times, &mut source.notices, file);
        source.series.extend(series);
    }
    if source.series.is_empty() {
        let message = "found no segment with rows, expected readings after the header";
        return Err(ReadError::new(file, Location::File, message));
    }
    source
        .notices
        .extend(encoding_notice(file, lines.encoding()));
    Ok(source)
}

/// Keys of a header, each with the cells behind it.
#[derive(Default)]
struct Header(Vec<(String, Vec<String>)>);

impl Header {
    fn of<'a>(&'a self, key: &str) -> Option<&'a [String]> {
        let found = self.0.iter().find(|(known, _)| known == key);
        found.map(|(_, cells)| cells.as_slice())
    }

    fn value(&self, key: &str) -> Option<&str> {
        self.of(key)?.first().map(String::as_str)
    }

    /// The cell of a column, from 1.
    fn at(&self, key: &str, column: usize) -> Option<&str> {
        let cell = self.of(key)?.get(column.checked_sub(1)?)?;
        Some(cell.as_str()).filter(|cell| !cell.is_empty())
    }
}

/// Reads a header up to its end.
fn header(lines: &mut Lines<'_>, separator: Separator) -> Result<Header, ReadError> {
    let mut header = Header::default();
    let mut is_special = false;
    while let Some((_, text)) = lines.next_line()? {
        let cells = Cells::of(text, separator);
        match cells.get(0) {
            END_OF_HEADER => return Ok(header),
            START_SPECIAL => is_special = true,
            END_SPECIAL => is_special = false,
            key if !is_special && !key.is_empty() => {
                let values = (1..cells.len()).map(|k| cells.get(k).to_owned());
                header.0.push((key.to_owned(), values.collect()));
            }
            _ => {}
        }
    }
    let message = format!("ends in a header, expected {END_OF_HEADER}");
    Err(ReadError::new(lines.file(), Location::File, message))
}

/// Columns that were recorded together.
struct Segment {
    header: Header,
    headings: Vec<String>,
    columns: Vec<Vec<f64>>,
    rows: usize,
}

/// The next segment; `None` at the end of the file.
fn segment(lines: &mut Lines<'_>, separator: Separator) -> Result<Option<Segment>, ReadError> {
    let has_header = loop {
        match lines.look_ahead(1)?.front() {
            None => return Ok(None),
            Some((_, text)) => {
                let cells = Cells::of(text, separator);
                if !cells.are_blank() {
                    break cells.iter().all(|cell| cell != X_VALUE);
                }
            }
        }
        lines.next_line()?;
    };
    let header = match has_header {
        true => header(lines, separator)?,
        false => Header::default(),
    };
    let Some((line, text)) = lines.next_line()? else {
        return Ok(None);
    };
    let cells = Cells::of(text, separator);
    let mut headings: Vec<String> = cells.iter().map(str::to_owned).collect();
    if !headings.iter().any(|heading| heading == X_VALUE) {
        let message = format!(
            "found {}, expected the row of names that begins with {X_VALUE}",
            quoted(cells.get(0))
        );
        return Err(ReadError::new(lines.file(), Location::Line(line), message));
    }
    if headings.last().is_some_and(|last| last == COMMENT) {
        headings.pop();
    }
    let mut columns = vec![Vec::new(); headings.len()];
    let mut rows = 0;
    let mut cells = Cells::default();
    // A blank line or the header of the next segment ends this one.
    while let Some((line, text)) = lines.look_ahead(1)?.front() {
        cells.split(text, separator);
        let line = *line;
        if cells.are_blank() || ["Channels", START_SPECIAL].contains(&cells.get(0)) {
            break;
        }
        lines.next_line()?;
        lines.take_values(columns.len())?;
        for (k, column) in columns.iter_mut().enumerate() {
            column.push(match parse_number(cells.get(k)) {
                Some((value, _)) => value,
                None if is_gap(cells.get(k)) => f64::NAN,
                None => {
                    let place = Location::Cell(line, headings[k].clone());
                    let message = format!("found {}, expected a number", quoted(cells.get(k)));
                    return Err(ReadError::new(lines.file(), place, message));
                }
            });
        }
        rows += 1;
    }
    Ok(Some(Segment {
        header,
        headings,
        columns,
        rows,
    }))
}

impl Segment {
    /// The channels with their times: those with the same times are one series.
    fn into_series(
        self,
        name: &str,
        has_times: bool,
        notices: &mut Vec<String>,
        file: &str,
    ) -> Vec<Series> {
        let Self {
            header,
            headings,
            columns,
            rows,
        } = self;
        if rows == 0 {
            notices.push(format!("{file}: {name} has no rows, left out"));
            return Vec::new();
        }
        let mut series: Vec<Series> = Vec::new();
        let mut times = None;
        let mut channel = 0;
        for (heading, column) in headings.into_iter().zip(columns) {
            if heading == X_VALUE {
                times = Some(Values::from(column)).filter(|_| has_times);
                continue;
            }
            channel += 1;
            let (title, unit) = split_heading(&heading);
            let stated = header.at("Y_Unit_Label", channel).map(str::to_owned);
            let is_time = header
                .at("X_Dimension", channel)
                .is_none_or(|dimension| dimension == "Time");
            let number = |key: &str| Some(parse_number(header.at(key, channel)?)?.0);
            let time_s = times.clone().or_else(|| {
                let step = number("Delta_X").filter(|step| *step > 0.0)?;
                let first = number("X0").unwrap_or(0.0);
                Some((0..rows).map(|row| first + step * row as f64).collect())
            });
            let time_s = time_s.filter(|_| is_time);
            let one = Channel {
                name: title,
                unit: stated.or(unit),
                values: column.into(),
            };
            match series.iter_mut().find(|known| known.time_s == time_s) {
                Some(known) => known.channels.push(one),
                None => series.push(Series {
                    name: match series.len() {
                        0 => name.to_owned(),
                        more => format!("{name}, times {}", more + 1),
                    },
                    rows,
                    time_s,
                    channels: vec![one],
                    texts: Vec::new(),
                }),
            }
        }
        for one in &mut series {
            make_unique(one.channels.iter_mut().map(|channel| &mut channel.name));
        }
        series
    }
}

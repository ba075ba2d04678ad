//! CSV export of TwinCAT 3 Scope.
//!
//! Blocks divided by one empty line: the file's header, one key a line; the channels' header, one key a line with a value
//! for each channel in every second cell; the data, a pair of cells (sample or time, value) for each channel. Channels
//! of slower rate have fewer rows. A line of empty cells and `EOF` close the file.

use tautline_files::{Location, ReadError, quoted};

use super::{encoding_notice, stem};
use crate::input::Input;
use crate::source::{Channel, Format, Series, Source};
use crate::text::{Cells, Decimal, Lines, Separator, is_gap, parse_number, parse_timestamp};
use crate::units::split_heading;
use crate::values::Values;

/// Most lines before the data.
const HEADER_LINES: usize = 200;

#[derive(Default)]
struct Header {
    names: Vec<String>,
    units: Vec<Option<String>>,
    sample_ms: Vec<Option<f64>>,
    /// Channels with a display scale factor.
    scaled: Vec<String>,
}

/// Times or samples, and values, of one channel.
#[derive(Clone, Default)]
struct Pairs {
    at: Vec<f64>,
    values: Vec<f64>,
}

pub(super) fn read(head: &[u8], input: Input<'_>, file: &str) -> Result<Source, ReadError> {
    let mut lines = Lines::new(head, input, file);
    let separator = separator(lines.look_ahead(1)?.front().map_or("", |(_, line)| line));
    let header = header(&mut lines, separator)?;
    let mut notices = Vec::new();
    let channels = data(&mut lines, separator, &header, &mut notices)?;
    notices.extend(encoding_notice(file, lines.encoding()));
    if !header.scaled.is_empty() {
        let names = header.scaled.join(", ");
        notices.push(format!(
            "{file}: a ScaleFactor other than 1 is stated for {names}; the values are used as written"
        ));
    }
    let series = by_time(channels, &header, &stem(file));
    Ok(Source {
        file: file.into(),
        format: Format::TwinCatScope,
        series,
        notices,
    })
}

/// The separator, which follows the first key, `Name`.
fn separator(first: &str) -> Separator {
    match first
        .trim_start_matches("Name")
        .trim_start_matches('"')
        .chars()
        .next()
    {
        Some(letter @ ('\t' | ',' | ';' | ':')) => Separator::Character(letter),
        _ => Separator::Blanks,
    }
}

fn header(lines: &mut Lines<'_>, separator: Separator) -> Result<Header, ReadError> {
    let file = lines.file();
    let mut header = Header::default();
    let mut cells = Cells::default();
    let mut blocks = 0;
    for _ in 0..HEADER_LINES {
        let Some((line, text)) = lines.next_line()? else {
            break;
        };
        cells.split(text, separator);
        if cells.are_blank() {
            blocks += 1;
            if blocks == 2 {
                break;
            }
            continue;
        }
        if blocks == 0 {
            continue;
        }
        let values: Vec<&str> = (1..cells.len()).step_by(2).map(|k| cells.get(k)).collect();
        let key = cells.get(0);
        if key == "Name" {
            header.names = values.iter().map(|name| (*name).to_owned()).collect();
            header.sample_ms = vec![None; values.len()];
            header.units = vec![None; values.len()];
        }
        if values.len() < header.names.len() {
            let message = format!(
                "found {} values of {}, expected one for each of {} channels",
                values.len(),
                quoted(key),
                header.names.len()
            );
            return Err(ReadError::new(file, Location::Line(line), message));
        }
        for (k, name) in header.names.clone().iter().enumerate() {
            match key.split(['[', ' ']).next().unwrap_or_default() {
                "SampleTime" => {
                    header.sample_ms[k] = parse_number(values[k]).map(|(value, _)| value);
                }
                "Unit" if !values[k].is_empty() => header.units[k] = Some(values[k].into()),
                "ScaleFactor" if parse_number(values[k]).is_some_and(|(value, _)| value != 1.0) => {
                    header.scaled.push(quoted(name));
                }
                _ => {}
            }
        }
    }
    if header.names.is_empty() || blocks < 2 {
        let message = "found no channel header that begins with \"Name\" between two empty lines";
        return Err(ReadError::new(file, Location::File, message));
    }
    Ok(header)
}

fn data(
    lines: &mut Lines<'_>,
    separator: Separator,
    header: &Header,
    notices: &mut Vec<String>,
) -> Result<Vec<Pairs>, ReadError> {
    let file = lines.file();
    let mut channels = vec![Pairs::default(); header.names.len()];
    let mut cells = Cells::default();
    let mut ended = false;
    let mut unread = 0_usize;
    let mut decimals = [false; 2];
    while let Some((line, text)) = lines.next_line()? {
        if text.trim() == "EOF" {
            ended = true;
            break;
        }
        cells.split(text, separator);
        if cells.are_blank() {
            continue;
        }
        for (k, channel) in channels.iter_mut().enumerate() {
            let (at, value) = (cells.get(2 * k), cells.get(2 * k + 1));
            if at.is_empty() && value.is_empty() {
                continue;
            }
            let place = || Location::Cell(line, header.names[k].clone());
            let unexpected = |found: &str, expected| {
                ReadError::new(
                    file,
                    place(),
                    format!("found {}, expected {expected}", quoted(found)),
                )
            };
            let time = parse_number(at)
                .map(|(time, _)| time)
                .or_else(|| parse_timestamp(at).map(|s| s * 1e3));
            let time = match time {
                Some(time) => time,
                // A truncated file ends within a pair.
                None if lines_end(text, at) => {
                    unread += 1;
                    continue;
                }
                None => return Err(unexpected(at, "a sample number or time")),
            };
            let value = match parse_number(value) {
                Some((value, sign)) => {
                    decimals[0] |= sign == Decimal::Point;
                    decimals[1] |= sign == Decimal::Comma;
                    value
                }
                None if is_gap(value) => f64::NAN,
                None => return Err(unexpected(value, "a number")),
            };
            if decimals == [true; 2] {
                let message = "found decimal points and decimal commas, expected one of the two";
                return Err(ReadError::new(file, place(), message));
            }
            channel.at.push(time);
            channel.values.push(value);
        }
    }
    if !ended {
        notices.push(format!("{file}: ends without EOF: the export was cut off"));
    }
    if unread > 0 {
        notices.push(format!("{file}: {unread} cells of its last row left out"));
    }
    if channels.iter().all(|channel| channel.at.is_empty()) {
        return Err(ReadError::new(
            file,
            Location::File,
            "found channels without samples, expected rows of data",
        ));
    }
    Ok(channels)
}

/// Whether an unreadable cell is the last of its line and at most two characters long, i.e. cut off.
fn lines_end(text: &str, cell: &str) -> bool {
    text.trim_end().ends_with(cell) && cell.len() < 3
}

/// Channels with the same times become one series.
fn by_time(channels: Vec<Pairs>, header: &Header, stem: &str) -> Vec<Series> {
    let mut series: Vec<Series> = Vec::new();
    for (k, pairs) in channels.into_iter().enumerate() {
        if pairs.at.is_empty() {
            continue;
        }
        let (name, unit) = split_heading(&header.names[k]);
        let channel = Channel {
            name,
            unit: header.units[k].clone().or(unit),
            values: pairs.values.into(),
        };
        let time_s = seconds(&pairs.at, header.sample_ms[k]);
        match series
            .iter_mut()
            .find(|series| series.time_s.as_ref() == Some(&time_s))
        {
            Some(series) => series.channels.push(channel),
            None => {
                let name = if series.is_empty() {
                    stem.to_owned()
                } else {
                    format!("{stem} ({})", series.len() + 1)
                };
                series.push(Series {
                    name,
                    rows: time_s.len(),
                    time_s: Some(time_s),
                    channels: vec![channel],
                    texts: Vec::new(),
                });
            }
        }
    }
    series
}

/// Times (s) from the first cell of each pair: sample number, or time in milliseconds.
fn seconds(at: &[f64], sample_ms: Option<f64>) -> Values {
    let counts = at
        .iter()
        .zip(at.iter().skip(1))
        .all(|(one, next)| next - one == 1.0);
    let factor = match sample_ms {
        Some(sample_ms) if counts => sample_ms * 1e-3,
        _ => 1e-3,
    };
    at.iter().map(|at| at * factor).collect()
}

//! CSV export of OptiTrack Motive, versions 1.2 and later.

use std::collections::HashMap;

use tautline_files::{Location, ReadError, quoted};

use super::{encoding_notice, stem};
use crate::input::Input;
use crate::source::{Channel, Format, Series, Source};
use crate::text::{Cells, Decimal, Lines, Separator, is_gap, parse_number};
use crate::values::{Values, fill};

/// Most lines before the data.
const HEADER_LINES: usize = 20;
const COMMA: Separator = Separator::Character(',');

pub(super) fn read(head: &[u8], input: Input<'_>, file: &str) -> Result<Source, ReadError> {
    let mut lines = Lines::new(head, input, file);
    let mut settings = HashMap::new();
    let mut rows: Vec<Vec<String>> = Vec::new();
    let axes = loop {
        let Some((line, text)) = lines.next_line()? else {
            return Err(ReadError::new(
                file,
                Location::File,
                "found no row that begins with \"Frame\", expected the header of the data",
            ));
        };
        let cells = Cells::of(text, COMMA);
        if line == 1 {
            let pairs = (0..cells.len() / 2)
                .map(|k| (cells.get(2 * k).to_owned(), cells.get(2 * k + 1).to_owned()));
            settings.extend(pairs);
        } else if cells.get(0) == "Frame" {
            break cells;
        } else if line as usize > HEADER_LINES {
            let message = "found no row that begins with \"Frame\" in the first lines, expected the header of the data";
            return Err(ReadError::new(file, Location::Line(line), message));
        } else if !cells.are_blank() {
            rows.push(cells.iter().map(str::to_owned).collect());
        }
    };
    let unit = match settings.get("Length Units").map(String::as_str) {
        Some("Meters") => "m",
        Some("Millimeters") => "mm",
        Some("Centimeters") => "cm",
        found => {
            let found = found.map_or("no entry".into(), quoted);
            let message = format!(
                "found {found} as \"Length Units\", expected Meters, Centimeters or Millimeters"
            );
            return Err(ReadError::new(file, Location::Line(1), message));
        }
    };
    let mut channels = headings(&rows, &axes, unit);
    let mut notices = Vec::new();
    let time_s = data(&mut lines, &axes, &mut channels, &mut notices)?;
    notices.extend(encoding_notice(file, lines.encoding()));
    if let Some(rotation) = settings
        .get("Rotation Type")
        .filter(|rotation| *rotation != "Quaternion")
    {
        notices.push(format!("{file}: rotations are given as {}, expected quaternions: their angles are not used as a pose", quoted(rotation)));
    }
    if let Some(space) = settings
        .get("Coordinate Space")
        .filter(|space| *space != "Global")
    {
        notices.push(format!(
            "{file}: coordinates are in the space {}, expected Global",
            quoted(space)
        ));
    }
    let series = Series {
        name: stem(file),
        rows: time_s.len(),
        time_s: Some(time_s),
        channels,
        texts: Vec::new(),
    };
    Ok(Source {
        file: file.into(),
        format: Format::Motive,
        series: vec![series],
        notices,
    })
}

/// Names `Body.Position.X` and units of the columns after frame and time.
fn headings(rows: &[Vec<String>], axes: &Cells, unit: &str) -> Vec<Channel> {
    let row = |key: &str| {
        rows.iter()
            .find(|row| row.iter().take(2).any(|cell| cell == key))
    };
    let cell = |row: Option<&Vec<String>>, k: usize| {
        row.and_then(|row| row.get(k)).cloned().unwrap_or_default()
    };
    let kind = rows.iter().find(|row| {
        row.iter()
            .any(|cell| cell == "Rotation" || cell == "Position")
    });
    (2..axes.len())
        .map(|k| {
            let (name, kind, axis) = (cell(row("Name"), k), cell(kind, k), axes.get(k));
            let parts: Vec<&str> = [name.as_str(), kind.as_str(), axis]
                .into_iter()
                .filter(|part| !part.is_empty())
                .collect();
            let unit = match kind.as_str() {
                "Position" | "Mean Marker Error" | "Error Per Marker" => Some(unit.to_owned()),
                _ => None,
            };
            Channel {
                name: parts.join("."),
                unit,
                values: Values::default(),
            }
        })
        .collect()
}

/// Fills the channels; returns the times of the frames (s).
fn data(
    lines: &mut Lines<'_>,
    axes: &Cells,
    channels: &mut [Channel],
    notices: &mut Vec<String>,
) -> Result<Values, ReadError> {
    let file = lines.file();
    let mut cells = Cells::default();
    let mut columns = vec![Vec::new(); channels.len()];
    let mut times = Vec::new();
    let mut frames = Frames::default();
    while let Some((line, text)) = lines.next_line()? {
        cells.split(text, COMMA);
        if cells.are_blank() {
            continue;
        }
        let error = |k: usize, found: &str| {
            let name = if k < 2 {
                axes.get(k).to_owned()
            } else {
                channels[k - 2].name.clone()
            };
            ReadError::new(
                file,
                Location::Cell(line, name),
                format!(
                    "found {}, expected a number with a decimal point",
                    quoted(found)
                ),
            )
        };
        let number = |k: usize| {
            parse_number(cells.get(k))
                .filter(|(_, sign)| *sign != Decimal::Comma)
                .map(|(value, _)| value)
        };
        if cells.len() + 1 < axes.len() && lines_are_over(text) {
            notices.push(format!(
                "{file}, line {line}: the last row ends after {} of {} cells: left out",
                cells.len(),
                axes.len()
            ));
            continue;
        }
        let (Some(frame), Some(time)) = (number(0), number(1)) else {
            let k = usize::from(number(0).is_some());
            return Err(error(k, cells.get(k)));
        };
        lines.take_values(columns.len())?;
        for (k, column) in (2..).zip(&mut columns) {
            column.push(match number(k) {
                Some(value) => value,
                None if is_gap(cells.get(k)) => f64::NAN,
                None => return Err(error(k, cells.get(k))),
            });
        }
        frames.add(frame);
        times.push(time);
    }
    if times.is_empty() {
        return Err(ReadError::new(
            file,
            Location::File,
            "found a header without frames, expected rows of data",
        ));
    }
    notices.extend(frames.notice(file));
    fill(channels, columns);
    Ok(times.into())
}

/// Whether a row with too few cells is truncated: complete rows end with all their separators.
fn lines_are_over(text: &str) -> bool {
    !text.ends_with(',')
}

/// Numbers of the frames.
#[derive(Default)]
pub(super) struct Frames {
    last: Option<f64>,
    missing: f64,
}

impl Frames {
    /// Adds the number of the next frame.
    pub fn add(&mut self, frame: f64) {
        if let Some(last) = self.last
            && frame > last + 1.0
        {
            self.missing += frame - last - 1.0;
        }
        self.last = Some(frame);
    }

    /// The sentence about frames that are missing.
    pub fn notice(&self, file: &str) -> Option<String> {
        (self.missing > 0.0)
            .then(|| format!("{file}: {} frames are missing in between", self.missing))
    }
}

//! Text export of Vicon Nexus: sections, each with its title alone on a line.

use tautline_files::{Location, ReadError, quoted};

use super::motive::Frames;
use super::{encoding_notice, stem};
use crate::input::Input;
use crate::source::{Channel, Format, Series, Source};
use crate::text::{Cells, Lines, Separator, is_gap, parse_number};
use crate::units::bare;
use crate::values::{Values, fill};

const TITLES: [&str; 6] = [
    "Trajectories",
    "Devices",
    "Joints",
    "Segments",
    "Model Outputs",
    "Events",
];

/// Whether a line is the title of a section.
pub(super) fn is_title(line: &str) -> bool {
    let line = line
        .trim_matches(|letter: char| letter.is_whitespace() || matches!(letter, ',' | ';' | '"'));
    TITLES.contains(&line)
}

pub(super) fn read(head: &[u8], input: Input<'_>, file: &str) -> Result<Source, ReadError> {
    let mut lines = Lines::new(head, input, file);
    let mut source = Source {
        file: file.into(),
        format: Format::Nexus,
        series: Vec::new(),
        notices: Vec::new(),
    };
    while let Some((line, text)) = lines.next_line()? {
        if text
            .trim_matches(|letter: char| letter.is_whitespace() || letter == ',')
            .is_empty()
        {
            continue;
        }
        if !is_title(text) {
            let message = format!(
                "found {}, expected the title of a section, such as Trajectories",
                quoted(text)
            );
            return Err(ReadError::new(file, Location::Line(line), message));
        }
        let title = text
            .trim_matches(|letter: char| letter.is_whitespace() || matches!(letter, ',' | '"'))
            .to_owned();
        if title == "Events" {
            while lines
                .next_line()?
                .is_some_and(|(_, text)| !text.trim().is_empty())
            {}
            source
                .notices
                .push(format!("{file}, line {line}: section Events left out"));
            continue;
        }
        let series = section(&mut lines, &title, &mut source.notices)?;
        source.series.push(series);
    }
    source
        .notices
        .extend(encoding_notice(file, lines.encoding()));
    Ok(source)
}

fn section(
    lines: &mut Lines<'_>,
    title: &str,
    notices: &mut Vec<String>,
) -> Result<Series, ReadError> {
    let file = lines.file();
    let next = |lines: &mut Lines<'_>, what: &str| {
        let line = lines
            .next_line()?
            .map(|(line, text)| (line, text.to_owned()));
        line.ok_or_else(|| {
            ReadError::new(
                file,
                Location::File,
                format!("ends in the section {title}, expected {what}"),
            )
        })
    };
    let (line, text) = next(lines, "the sampling rate")?;
    let separator = |text: &str| Separator::Character(if text.contains('\t') { '\t' } else { ',' });
    let rate = Cells::of(&text, separator(&text));
    let Some(rate_hz) = parse_number(rate.get(0))
        .map(|(rate, _)| rate)
        .filter(|rate| *rate > 0.0)
    else {
        return Err(ReadError::new(
            file,
            Location::Line(line),
            format!("found {}, expected the sampling rate in Hz", quoted(&text)),
        ));
    };
    let (_, text) = next(lines, "the names of what was recorded")?;
    let separator = separator(&text);
    let names = Cells::of(&text, separator);
    let (line, text) = next(lines, "the row that begins with Frame")?;
    let axes = Cells::of(&text, separator);
    if axes.get(0) != "Frame" {
        return Err(ReadError::new(
            file,
            Location::Line(line),
            format!(
                "found {}, expected the row that begins with Frame",
                quoted(axes.get(0))
            ),
        ));
    }
    let (_, text) = next(lines, "the row of units")?;
    let units = Cells::of(&text, separator);
    let mut channels = headings(&names, &axes, &units);
    let mut frames = Frames::default();
    let mut at = Vec::new();
    let mut columns = vec![Vec::new(); channels.len()];
    let mut cells = Cells::default();
    while let Some((line, text)) = lines.next_line()? {
        cells.split(text, separator);
        if cells.are_blank() {
            break;
        }
        let error = |k: usize| {
            let name = if k < 2 {
                axes.get(k).to_owned()
            } else {
                channels[k - 2].name.clone()
            };
            ReadError::new(
                file,
                Location::Cell(line, name),
                format!("found {}, expected a number", quoted(cells.get(k))),
            )
        };
        let frame = parse_number(cells.get(0))
            .map(|(frame, _)| frame)
            .ok_or_else(|| error(0))?;
        lines.take_values(columns.len())?;
        for (k, column) in (2..).zip(&mut columns) {
            column.push(match parse_number(cells.get(k)) {
                Some((value, _)) => value,
                None if is_gap(cells.get(k)) => f64::NAN,
                None => return Err(error(k)),
            });
        }
        frames.add(frame);
        at.push((
            frame,
            parse_number(cells.get(1)).map_or(0.0, |(frame, _)| frame),
        ));
    }
    if at.is_empty() {
        return Err(ReadError::new(
            file,
            Location::Line(line),
            format!("found no frame in the section {title}, expected rows of data"),
        ));
    }
    notices.extend(frames.notice(file));
    fill(&mut channels, columns);
    Ok(Series {
        name: format!("{} {title}", stem(file)),
        rows: at.len(),
        time_s: Some(times(&at, rate_hz)),
        channels,
        texts: Vec::new(),
    })
}

/// Names `subject:marker.X` and units of the columns after frame and sub frame.
fn headings(names: &Cells, axes: &Cells, units: &Cells) -> Vec<Channel> {
    let mut owner = String::new();
    (2..axes.len())
        .map(|k| {
            if !names.get(k).is_empty() {
                owner = names.get(k).into();
            }
            let axis = axes.get(k);
            let name = if axis.is_empty() {
                owner.clone()
            } else {
                format!("{owner}.{axis}")
            };
            let unit = Some(bare(units.get(k)).to_owned()).filter(|unit| !unit.is_empty());
            Channel {
                name,
                unit,
                values: Values::default(),
            }
        })
        .collect()
}

/// Times (s) since frame 1. Analogue devices sample several times a frame; the rate of a section is that of its rows.
fn times(at: &[(f64, f64)], rate_hz: f64) -> Values {
    let per_frame = at.iter().fold(0.0_f64, |most, (_, sub)| most.max(*sub)) + 1.0;
    at.iter()
        .map(|(frame, sub)| ((frame - 1.0) * per_frame + sub) / rate_hz)
        .collect()
}

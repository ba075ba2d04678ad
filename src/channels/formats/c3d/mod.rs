//! Motion capture in C3D: markers, and the analog channels that were sampled with them.
//!
//! A header of 512 bytes, parameters by name, and frames of which each has four numbers for every marker and, behind them, the
//! samples of the analog channels. Markers have the names of a text export of the same capture.

mod parameters;
mod processor;

use std::io::{BufReader, ErrorKind, Read, Seek, SeekFrom};

use self::parameters::Parameters;
use self::processor::Processor;
use tautline_files::{Location, ReadError, quoted};

use crate::input::Input;
use crate::source::{Channel, Format, Series, Source};
use crate::units::bare;
use crate::values::{Values, fill};

/// Bytes of the header, and of a block in which places are counted.
const BLOCK: u64 = 512;
/// Key word in the header that announces events with labels.
const HAS_EVENTS: u16 = 12345;
/// Parameters that list the points that are not markers, and their units.
const OTHER_POINTS: [(&str, &str); 5] = [
    ("ANGLES", "ANGLE_UNITS"),
    ("FORCES", "FORCE_UNITS"),
    ("MOMENTS", "MOMENT_UNITS"),
    ("POWERS", "POWER_UNITS"),
    ("SCALARS", "SCALAR_UNITS"),
];

/// Reads a file, whose series begin with `name`.
pub(super) fn read(mut input: Input<'_>, file: &str, name: &str) -> Result<Source, ReadError> {
    let refuse = |message: String| ReadError::new(file, Location::File, message);
    let failed = |error: std::io::Error| match error.kind() {
        ErrorKind::UnexpectedEof => refuse("ends before its data, expected C3D".into()),
        _ => ReadError::io(file, Location::File, &error),
    };
    let size = input.file().and_then(|file| file.metadata());
    let size = size.map_err(failed)?.len();
    let mut bytes = [0; BLOCK as usize];
    input.read_exact(&mut bytes).map_err(failed)?;
    let parameters_at = BLOCK * (u64::from(bytes[0]) - 1);
    input.seek(SeekFrom::Start(parameters_at)).map_err(failed)?;
    let mut begin = [0; 4];
    input.read_exact(&mut begin).map_err(failed)?;
    let [_, _, blocks, code] = begin;
    let Some(processor) = Processor::of(code) else {
        return Err(refuse(format!(
            "found processor {code}, expected 84, 85 or 86: C3D of Intel, DEC or MIPS"
        )));
    };
    let header = Header::read(processor, &bytes);
    // Long parameters have more blocks than their number can say.
    let end = match BLOCK * header.data_block.saturating_sub(1) {
        data_at if data_at > parameters_at => data_at,
        _ => parameters_at + BLOCK * u64::from(blocks),
    };
    let mut bytes = Vec::new();
    let length = end.saturating_sub(parameters_at + 4);
    input
        .by_ref()
        .take(length)
        .read_to_end(&mut bytes)
        .map_err(failed)?;
    let parameters = Parameters::parse(processor, &bytes);
    let mut notices = Vec::new();
    if !parameters.is_whole {
        notices.push("its parameters are damaged; those after the damage are left out".to_owned());
    }
    let frames = Frames::of(processor, &header, &parameters, size).map_err(refuse)?;
    input.seek(SeekFrom::Start(frames.at)).map_err(failed)?;
    let mut input = BufReader::new(input);
    let series = frames
        .read(&mut input, (&parameters, name), &mut notices)
        .map_err(failed)?;
    notices.extend(left_out(&header, &parameters));
    let notices = notices.iter().map(|notice| format!("{file}: {notice}"));
    Ok(Source {
        file: file.into(),
        format: Format::C3d,
        series,
        notices: notices.collect(),
    })
}

/// The fields of the header that are used.
struct Header {
    points: usize,
    /// Number of analog samples per frame.
    analog: usize,
    /// Numbers of the first and the last frame.
    frames: [u16; 2],
    scale: f64,
    data_block: u64,
    /// Samples per analog channel in a frame.
    samples: usize,
    rate_hz: f64,
    /// Number of events in the header.
    events: u16,
}

impl Header {
    fn read(processor: Processor, bytes: &[u8; BLOCK as usize]) -> Self {
        // The format specification numbers words from 1.
        let word = |k: usize| processor.integer([bytes[2 * k - 2], bytes[2 * k - 1]]);
        let float = |k: usize| {
            let [a, b] = [2 * k - 2, 2 * k];
            processor.float([bytes[a], bytes[a + 1], bytes[b], bytes[b + 1]])
        };
        Self {
            points: word(2).into(),
            analog: word(3).into(),
            frames: [word(4), word(5)],
            scale: float(7),
            data_block: word(9).into(),
            samples: word(10).into(),
            rate_hz: float(11),
            events: if word(150) == HAS_EVENTS {
                word(151)
            } else {
                0
            },
        }
    }
}

/// Position, number and layout of the frames.
struct Frames {
    processor: Processor,
    /// Offset of the first frame (bytes).
    at: u64,
    /// Number of frames present in the file, and number stated.
    held: u64,
    count: u64,
    /// Number of the first one.
    first: f64,
    /// `None` where none is stated.
    rate_hz: Option<f64>,
    points: usize,
    channels: usize,
    samples: usize,
    /// Scale factor of coordinates; `None` if they are floating-point numbers.
    scale: Option<f64>,
}

impl Frames {
    /// Locates the frames in a file of `size` bytes.
    fn of(
        processor: Processor,
        header: &Header,
        parameters: &Parameters,
        size: u64,
    ) -> Result<Self, String> {
        let one = |name: &str| parameters.numbers("POINT", name).first().copied();
        let samples = header.samples.max(1);
        let channels = header.analog / samples;
        for (group, found) in [("POINT", header.points), ("ANALOG", channels)] {
            let used = parameters.counts(group, "USED");
            if let Some(used) = used.first().filter(|used| **used != found as f64) {
                return Err(format!(
                    "found {found} in its header and {used} as {group}:USED, expected the same number"
                ));
            }
        }
        if !header.analog.is_multiple_of(samples) {
            let analog = header.analog;
            return Err(format!(
                "found {analog} analog samples in a frame, expected {samples} per channel"
            ));
        }
        let scale = one("SCALE").unwrap_or(header.scale);
        if header.points > 0 && (scale == 0.0 || !scale.is_finite()) {
            return Err(format!(
                "found {scale} as POINT:SCALE, expected a finite factor"
            ));
        }
        let data_block = match header.data_block {
            0 => one("DATA_START").map_or(0, |block| block as u64),
            block => block,
        };
        let rate_hz = one("RATE").unwrap_or(header.rate_hz);
        let mut frames = Self {
            processor,
            at: BLOCK * data_block.saturating_sub(1),
            held: 0,
            count: 0,
            first: first_frame(header, parameters),
            rate_hz: Some(rate_hz).filter(|rate| *rate > 0.0 && rate.is_finite()),
            points: header.points,
            channels,
            samples,
            scale: Some(scale).filter(|scale| *scale > 0.0),
        };
        if frames.numbers() == 0 {
            return Err("found neither points nor analog channels, expected readings".into());
        }
        frames.held = size.saturating_sub(frames.at) / frames.bytes() as u64;
        if frames.held == 0 || frames.at < BLOCK {
            return Err("found no frame, expected data after the parameters".into());
        }
        frames.count = frame_count(header, parameters, frames.held);
        Ok(frames)
    }

    /// Numbers of a frame.
    fn numbers(&self) -> usize {
        4 * self.points + self.channels * self.samples
    }

    /// Bytes of a frame.
    fn bytes(&self) -> usize {
        let number = if self.scale.is_some() { 2 } else { 4 };
        number * self.numbers()
    }

    /// The unscaled number at an index of a frame.
    fn number(&self, frame: &[u8], k: usize, is_unsigned: bool) -> f64 {
        if self.scale.is_none() {
            let at = 4 * k;
            let bytes = [frame[at], frame[at + 1], frame[at + 2], frame[at + 3]];
            return self.processor.float(bytes);
        }
        let word = self.processor.integer([frame[2 * k], frame[2 * k + 1]]);
        match is_unsigned {
            true => f64::from(word),
            false => f64::from(word.cast_signed()),
        }
    }

    /// Reads markers and analog channels into one series each, whose names begin with `name`.
    fn read(
        &self,
        input: &mut impl Read,
        (parameters, name): (&Parameters, &str),
        notices: &mut Vec<String>,
    ) -> std::io::Result<Vec<Series>> {
        let analog = Analog::of(parameters, self.channels);
        let mut points = vec![Vec::new(); 3 * self.points];
        let mut channels = vec![Vec::new(); self.channels];
        let mut frame = vec![0; self.bytes()];
        let count = self.count.min(self.held);
        for _ in 0..count {
            input.read_exact(&mut frame)?;
            for (k, values) in points.iter_mut().enumerate() {
                values.push(self.coordinate(&frame, k));
            }
            for at in 0..self.channels * self.samples {
                let k = at % self.channels;
                let number = self.number(&frame, 4 * self.points + at, analog.is_unsigned);
                channels[k].push(analog.value(k, number));
            }
        }
        self.notice(notices);
        let series =
            |title: &str, mut channels: Vec<Channel>, columns: Vec<Vec<f64>>, samples: usize| {
                fill(&mut channels, columns);
                let rows = count as usize * samples;
                Series {
                    name: format!("{name} {title}"),
                    rows,
                    time_s: self.times(rows, samples),
                    channels,
                    texts: Vec::new(),
                }
            };
        let headings = point_headings(parameters, self.points, notices);
        let points = series("Trajectories", headings, points, 1);
        let analog = series("Devices", analog.headings(notices), channels, self.samples);
        let mut all = vec![points, analog];
        all.retain(|one| !one.channels.is_empty());
        Ok(all)
    }

    /// Adds notices about missing or surplus frames.
    fn notice(&self, notices: &mut Vec<String>) {
        let Self { held, count, .. } = self;
        if held < count {
            notices.push(format!("ends after {held} of {count} frames"));
        }
        // The last block is padded.
        let others = held.saturating_sub(*count);
        if others * self.bytes() as u64 >= BLOCK {
            notices.push(format!(
                "states {count} frames; data that could be {others} more are left out"
            ));
        }
        if self.rate_hz.is_none() {
            notices.push("states no sampling rate, so its rows have no times".into());
        }
    }

    /// A coordinate, of which each point has three and a number that is negative where the point was not seen.
    fn coordinate(&self, frame: &[u8], k: usize) -> f64 {
        let (point, axis) = (k / 3, k % 3);
        let is_lost = self.number(frame, 4 * point + 3, false) < 0.0;
        match is_lost {
            true => f64::NAN,
            false => self.number(frame, 4 * point + axis, false) * self.scale.unwrap_or(1.0),
        }
    }

    /// Times (s) of the samples since frame 1.
    fn times(&self, rows: usize, samples: usize) -> Option<Values> {
        let rate_hz = self.rate_hz? * samples as f64;
        let begin = (self.first - 1.0) * samples as f64;
        let times = (0..rows).map(|row| (begin + row as f64) / rate_hz);
        Some(times.collect())
    }
}

/// The number of a frame whose halves are two words, lower one first.
fn long_number(words: &[f64]) -> Option<f64> {
    match words {
        [low, high, ..] => Some(low + 65536.0 * high),
        _ => None,
    }
}

fn first_frame(header: &Header, parameters: &Parameters) -> f64 {
    let long = long_number(&parameters.counts("TRIAL", "ACTUAL_START_FIELD"));
    let long = long.filter(|first| first.is_finite());
    long.unwrap_or(header.frames[0].into()).max(1.0)
}

/// The stated number of frames. Long captures store it in additional fields while the older ones are truncated: the largest
/// number that the file can hold is correct.
fn frame_count(header: &Header, parameters: &Parameters, held: u64) -> u64 {
    let [first, last] = header.frames.map(f64::from);
    let begin = long_number(&parameters.counts("TRIAL", "ACTUAL_START_FIELD"));
    let end = long_number(&parameters.counts("TRIAL", "ACTUAL_END_FIELD"));
    let stated = |name: &str| parameters.counts("POINT", name).first().copied();
    let counts = [
        Some(last - first + 1.0),
        stated("FRAMES"),
        stated("LONG_FRAMES"),
        begin.zip(end).map(|(begin, end)| end - begin + 1.0),
    ];
    let counts = counts.into_iter().flatten().filter(|count| *count >= 1.0);
    let counts: Vec<u64> = counts.map(|count| count as u64).collect();
    let fitting = counts.iter().filter(|count| **count <= held).max();
    let count = fitting.or(counts.iter().min());
    count.copied().unwrap_or(held)
}

/// Names and units of coordinates.
fn point_headings(
    parameters: &Parameters,
    points: usize,
    notices: &mut Vec<String>,
) -> Vec<Channel> {
    let names = names(parameters, "POINT", points, notices);
    let unit = |name: &str| unit_of(parameters.texts("POINT", name).first());
    let others = OTHER_POINTS.map(|(kind, units)| (parameters.texts("POINT", kind), unit(units)));
    let lengths = unit("UNITS");
    let mut headings = Vec::new();
    for name in names {
        let other = others.iter().find(|(known, _)| known.contains(&name));
        let unit = other.map_or(&lengths, |(_, unit)| unit);
        headings
            .extend(["X", "Y", "Z"].map(|axis| heading(format!("{name}.{axis}"), unit.clone())));
    }
    headings
}

fn heading(name: String, unit: Option<String>) -> Channel {
    Channel {
        name,
        unit,
        values: Values::default(),
    }
}

fn unit_of(text: Option<&String>) -> Option<String> {
    let unit = text.map(|text| bare(text).to_owned());
    unit.filter(|unit| !unit.is_empty())
}

/// The labels of a group; `point_7` for a missing one.
fn names(
    parameters: &Parameters,
    group: &str,
    count: usize,
    notices: &mut Vec<String>,
) -> Vec<String> {
    let mut names = parameters.texts(group, "LABELS");
    names.resize(count, String::new());
    let kind = group.to_lowercase();
    let mut unnamed = 0;
    for (k, name) in names.iter_mut().enumerate() {
        if name.is_empty() {
            *name = format!("{kind}_{}", k + 1);
            unnamed += 1;
        }
    }
    if unnamed > 0 {
        notices.push(format!(
            "{unnamed} of {count} labels of {group} are empty; their channels are called {kind}_1, {kind}_2 and so on"
        ));
    }
    names
}

/// Scaling of the analog channels.
struct Analog {
    names: Vec<String>,
    units: Vec<String>,
    offsets: Vec<f64>,
    scales: Vec<f64>,
    /// Common scale factor.
    scale: f64,
    is_unsigned: bool,
    unnamed: Vec<String>,
}

impl Analog {
    fn of(parameters: &Parameters, channels: usize) -> Self {
        let format = parameters.texts("ANALOG", "FORMAT");
        let is_unsigned = format.first().is_some_and(|format| format == "UNSIGNED");
        let mut unnamed = Vec::new();
        Self {
            names: names(parameters, "ANALOG", channels, &mut unnamed),
            units: parameters.texts("ANALOG", "UNITS"),
            offsets: match is_unsigned {
                true => parameters.counts("ANALOG", "OFFSET"),
                false => parameters.numbers("ANALOG", "OFFSET"),
            },
            scales: parameters.numbers("ANALOG", "SCALE"),
            scale: parameters
                .numbers("ANALOG", "GEN_SCALE")
                .first()
                .copied()
                .unwrap_or(1.0),
            is_unsigned,
            unnamed,
        }
    }

    /// The scaled value of a channel.
    fn value(&self, channel: usize, number: f64) -> f64 {
        let offset = self.offsets.get(channel).copied().unwrap_or(0.0);
        let scale = self.scales.get(channel).copied().unwrap_or(1.0);
        (number - offset) * scale * self.scale
    }

    /// Names and units of the channels.
    fn headings(&self, notices: &mut Vec<String>) -> Vec<Channel> {
        notices.extend_from_slice(&self.unnamed);
        let names = self.names.iter().enumerate();
        names
            .map(|(k, name)| heading(name.clone(), unit_of(self.units.get(k))))
            .collect()
    }
}

/// Notices about content other than markers and analog channels, and about the axes.
fn left_out(header: &Header, parameters: &Parameters) -> Vec<String> {
    let used = |group: &str| {
        let used = parameters.counts(group, "USED").first().copied();
        used.filter(|used| *used > 0.0)
    };
    let events = used("EVENT").or(Some(f64::from(header.events)).filter(|events| *events > 0.0));
    let mut notices = Vec::new();
    if let Some(events) = events {
        notices.push(format!("{events} events left out"));
    }
    if let Some(rotations) = used("ROTATION") {
        notices.push(format!("rotations of {rotations} segments left out"));
    }
    let up = parameters.texts("POINT", "Y_SCREEN");
    if let Some(up) = up.first().filter(|up| up.contains(['X', 'Y'])) {
        notices.push(format!(
            "its axis {} points up, expected +Z: check which axis is vertical",
            quoted(up)
        ));
    }
    notices
}

//! ROS recordings: every topic is a series, its messages are decoded with the definitions in the recording.
//!
//! The files are read sequentially, record by record, so that a truncated recording is read as far as possible.

pub(super) mod bag;
mod definitions;
mod layout;
pub(super) mod mcap;
mod wire;

use std::collections::HashMap;
use std::io;

use self::definitions::{Definitions, FieldType};
use self::layout::Layout;
use self::wire::Wire;
use tautline_files::{Location, ReadError, quoted};

use crate::memory::MemoryBudget;
use crate::source::{Channel, FillingTexts, Format, Series, Source};

/// Maximum record length as a multiple of the file size: a compressed record expands, but a damaged length must not
/// allocate memory without data to fill it.
const RECORD_PER_FILE: u64 = 64;
/// Lower and upper bound of that limit (bytes).
const RECORD: [u64; 2] = [1 << 20, 256 << 20];
/// Most frames of a topic of transforms.
const MOST_FRAMES: usize = 256;

/// Notice about a recording that was not closed.
const CUT_OFF: &str = "has no end: the recorder was stopped, or the file was cut off";

/// Maximum record length in a file of a given size (bytes).
fn longest_record(bytes: u64) -> u64 {
    (RECORD_PER_FILE.saturating_mul(bytes)).clamp(RECORD[0], RECORD[1])
}

/// State of reading.
struct Recording {
    connections: HashMap<u32, Kept>,
    topics: Vec<Topic>,
    budget: MemoryBudget,
    notices: Vec<String>,
}

/// Handling of the messages of a connection.
enum Kept {
    Topic(usize),
    /// Left out, with the notice that states why, to be issued with the first message.
    LeftOut(Option<String>),
}

struct Topic {
    name: String,
    /// Index of its message type.
    kind: u32,
    decoder: Decoder,
    layout: Layout,
    series: Vec<Rows>,
    /// Number of messages that do not match their type.
    unread: usize,
    /// Whether the topic has more frames than the maximum, which are left out.
    has_more_frames: bool,
}

/// Decoder of messages.
enum Decoder {
    /// By their type.
    Typed(Begin, Definitions),
    /// Transforms, with one series per frame.
    Transforms(Begin, Definitions, FieldType),
    Json,
}

/// Begins a message, if it is in the encoding of its topic.
type Begin = for<'a> fn(&'a [u8]) -> Option<Wire<'a>>;

impl Decoder {
    /// The decoder of messages of a type; the error states why they are left out.
    fn typed(begin: Begin, definitions: Definitions) -> Result<Self, String> {
        if let Some(what) = no_reading(&definitions.message().name) {
            return Err(what.into());
        }
        Ok(match definitions.transforms() {
            Some(kind) => Self::Transforms(begin, definitions, kind),
            None => Self::Typed(begin, definitions),
        })
    }
}

/// A series that is being filled.
#[derive(Default)]
struct Rows {
    name: String,
    /// The frame of transforms.
    frame: String,
    count: usize,
    time_s: Vec<f64>,
    numbers: Vec<Vec<f64>>,
    texts: Vec<Texts>,
}

#[derive(Default)]
struct Texts {
    all: FillingTexts,
    has_any: bool,
}

impl Recording {
    /// An empty series whose rows take memory from `budget`.
    fn within(budget: &MemoryBudget) -> Self {
        Self {
            connections: HashMap::new(),
            topics: Vec::new(),
            budget: budget.clone(),
            notices: Vec::new(),
        }
    }

    /// Registers a connection; each chunk may repeat the connections of its messages.
    fn connect(
        &mut self,
        id: u32,
        topic: &str,
        kind: u32,
        decoder: impl FnOnce() -> Result<Decoder, String>,
    ) {
        if self.connections.contains_key(&id) {
            return;
        }
        // A topic with several publishers may have a connection for each.
        let is_same = |one: &Topic| one.name == *topic && one.kind == kind;
        let kept = match self.topics.iter().position(is_same) {
            Some(place) => Kept::Topic(place),
            None => match decoder() {
                Ok(decoder) => {
                    self.topics.push(Topic {
                        name: topic.to_owned(),
                        kind,
                        decoder,
                        layout: Layout::default(),
                        series: Vec::new(),
                        unread: 0,
                        has_more_frames: false,
                    });
                    Kept::Topic(self.topics.len() - 1)
                }
                Err(why) => {
                    let notice = format!("topic {}: {why}, left out", quoted(topic));
                    Kept::LeftOut(Some(notice))
                }
            },
        };
        self.connections.insert(id, kept);
    }

    /// Handles a message of a connection with its log time (s).
    fn message(&mut self, id: u32, log_s: f64, data: &[u8]) -> io::Result<()> {
        match self.connections.get_mut(&id) {
            Some(Kept::Topic(place)) => self.topics[*place].message(data, log_s, &self.budget),
            Some(Kept::LeftOut(notice)) => {
                self.notices.extend(notice.take());
                Ok(())
            }
            None => Ok(()),
        }
    }

    /// The source; `end` describes an abnormal end, and `others` are further notices.
    fn source(
        self,
        file: &str,
        format: Format,
        end: Option<String>,
        others: Vec<String>,
    ) -> Result<Source, ReadError> {
        let mut notices = Vec::new();
        let series = self.finish(&mut notices);
        if series.is_empty() {
            let message = match (end, notices.first().or(others.first())) {
                (Some(end), None) => format!("{end}, expected a readable {}", format.name()),
                (_, Some(notice)) => format!("found no topic with readings ({notice})"),
                (None, None) => "found no messages, expected readings".to_owned(),
            };
            return Err(ReadError::new(file, Location::File, message));
        }
        if let Some(end) = end {
            notices.push(format!("{end}; it is read as far as possible"));
        }
        notices.extend(others);
        let notices = notices.iter().map(|notice| format!("{file}: {notice}"));
        Ok(Source {
            file: file.into(),
            format,
            series,
            notices: notices.collect(),
        })
    }

    fn finish(self, notices: &mut Vec<String>) -> Vec<Series> {
        let mut series = Vec::new();
        notices.extend(self.notices);
        for topic in self.topics {
            let name = quoted(&topic.name);
            let Layout {
                columns,
                texts,
                left_out,
                ..
            } = topic.layout;
            for what in left_out {
                notices.push(format!("topic {name}: {what}, left out"));
            }
            if topic.unread > 0 {
                let count = topic.unread;
                notices.push(format!(
                    "topic {name}: messages that do not fit their type, left out ({count})"
                ));
            }
            if topic.has_more_frames {
                notices.push(format!(
                    "topic {name}: more than {MOST_FRAMES} frames, the others left out"
                ));
            }
            for rows in topic.series {
                let numbers = columns.iter().zip(rows.numbers);
                let channels = numbers.map(|(column, values)| Channel {
                    name: column.name.clone(),
                    unit: column.is_time.then(|| "s".to_owned()),
                    values: values.into(),
                });
                let mut kept = Vec::new();
                for (text, texts) in texts.iter().zip(rows.texts) {
                    // Many messages name no frame.
                    if texts.has_any {
                        match texts.all.finish(text) {
                            Ok(texts) => kept.push(texts),
                            Err(why) => {
                                notices.push(format!("topic {name}, {}: {why}", quoted(text)));
                            }
                        }
                    }
                }
                let one = Series {
                    name: rows.name,
                    rows: rows.count,
                    time_s: Some(rows.time_s.into()),
                    channels: channels.collect(),
                    texts: kept,
                };
                if one.channels.is_empty() && one.texts.is_empty() {
                    notices.push(format!("topic {name}: no numbers, left out"));
                } else {
                    series.push(one);
                }
            }
        }
        series
    }
}

impl Topic {
    fn message(&mut self, data: &[u8], log_s: f64, budget: &MemoryBudget) -> io::Result<()> {
        let Self {
            decoder,
            layout,
            name,
            ..
        } = self;
        let read = match decoder {
            Decoder::Json => layout.read_json(data),
            Decoder::Typed(begin, definitions) => begin(data).and_then(|mut wire| {
                let root = match definitions.is_only_data() {
                    true => name.trim_matches('/').replace('/', "."),
                    false => String::new(),
                };
                layout.read(definitions, FieldType::Nested(0), &mut wire, &root)
            }),
            Decoder::Transforms(begin, definitions, kind) => {
                let Some(mut wire) = begin(data) else {
                    self.unread += 1;
                    return Ok(());
                };
                for _ in 0..wire.count().unwrap_or(0) {
                    if layout.read(definitions, *kind, &mut wire, "").is_none() {
                        self.unread += 1;
                        break;
                    }
                    let texts = layout.texts.iter().zip(&layout.row_texts);
                    let mut frames = texts.filter(|(name, _)| *name == "child_frame_id");
                    let frame = frames.next().map_or("", |(_, frame)| frame.as_str());
                    let known = self.series.iter().position(|rows| rows.frame == frame);
                    let place = match known {
                        Some(place) => place,
                        None if self.series.len() >= MOST_FRAMES => {
                            self.has_more_frames = true;
                            continue;
                        }
                        None => {
                            let name = format!("{name} {frame}");
                            self.series.push(Rows::new(name, frame, layout));
                            self.series.len() - 1
                        }
                    };
                    self.series[place].push(layout, log_s, budget)?;
                }
                return Ok(());
            }
        };
        if read.is_none() {
            self.unread += 1;
            return Ok(());
        }
        if self.series.is_empty() {
            self.series.push(Rows::new(name.clone(), "", layout));
        }
        self.series[0].push(layout, log_s, budget)
    }
}

impl Rows {
    fn new(name: String, frame: &str, layout: &Layout) -> Self {
        let texts = layout.texts.iter();
        Self {
            name: name.replace(char::is_control, "?"),
            frame: frame.to_owned(),
            numbers: vec![Vec::new(); layout.columns.len()],
            texts: texts.map(|_| Texts::default()).collect(),
            ..Self::default()
        }
    }

    /// Adds the message read last.
    fn push(&mut self, layout: &Layout, log_s: f64, budget: &MemoryBudget) -> io::Result<()> {
        // Later messages may be far shorter than the first one.
        budget.take_values(1 + self.numbers.len() + self.texts.len())?;
        self.time_s.push(layout.stamp_s.unwrap_or(log_s));
        for (values, value) in self.numbers.iter_mut().zip(&layout.row) {
            values.push(*value);
        }
        for (texts, text) in self.texts.iter_mut().zip(&layout.row_texts) {
            texts.all.push(text);
            texts.has_any |= !text.is_empty();
        }
        self.count += 1;
        Ok(())
    }
}

/// Content of message types known to have no readings.
fn no_reading(kind: &str) -> Option<&'static str> {
    match kind.split_once('/')? {
        ("rcl_interfaces" | "diagnostic_msgs", _) | ("rosgraph_msgs", "Log") => {
            Some("log messages")
        }
        ("sensor_msgs", "Image" | "CompressedImage") => Some("images"),
        ("sensor_msgs", "PointCloud" | "PointCloud2") => Some("point clouds"),
        _ => None,
    }
}

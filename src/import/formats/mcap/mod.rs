//! Recordings of ROS 2 in MCAP: every topic is a series, its messages are decoded by the types that the recording holds.
//!
//! The file is read from its beginning, record by record, so that a recording without its end is read as far as it goes.

mod cdr;
mod layout;
mod schema;

use std::collections::HashMap;
use std::io::{self, Read};

use mcap::McapError;
use mcap::records::{Channel as Connection, MessageHeader, Record, op};
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};
use tautline_session::{Place, ReadError, quoted, read_damaged};

use self::cdr::Cdr;
use self::layout::Layout;
use self::schema::{Definitions, Kind};
use crate::input::Input;
use crate::source::{Channel, FillingTexts, Format, Series, Source};
use crate::values::{Filling, Storage};

/// Bytes that are read at a time.
const BLOCK: usize = 64 << 10;
/// Bytes of the longest record, as a multiple of those of the file: a compressed one is larger than what is stored, and a
/// damaged length must not take memory that nothing fills.
const RECORD_PER_FILE: u64 = 64;
/// Limits between which that is kept.
const RECORD: [u64; 2] = [1 << 20, 256 << 20];
/// Most frames of a topic of transforms.
const MOST_FRAMES: usize = 256;

pub(super) fn read(input: &mut Input<'_>, file: &str) -> Result<Source, ReadError> {
    let io = |error: io::Error| ReadError::io(file, Place::File, &error);
    let bytes = input.file().and_then(|file| file.metadata()).map_err(io)?;
    let longest = (RECORD_PER_FILE * bytes.len()).clamp(RECORD[0], RECORD[1]);
    let options = LinearReaderOptions::default()
        .with_validate_chunk_crcs(true)
        .with_record_length_limit(longest as usize);
    let mut reader = LinearReader::new_with_options(options);
    let mut recording = Recording::default();
    let mut damaged_chunks = 0_usize;
    let end = loop {
        // The reader is of others, and the file may be damaged.
        match read_damaged(|| reader.next_event()) {
            Some(None) => break None,
            Some(Some(Ok(LinearReadEvent::ReadRequest(_)))) => {
                let read = input.read(reader.insert(BLOCK)).map_err(io)?;
                reader.notify_read(read);
            }
            // What follows is a summary of what was read.
            Some(Some(Ok(LinearReadEvent::Record { opcode, .. }))) if opcode == op::DATA_END => {
                break None;
            }
            Some(Some(Ok(LinearReadEvent::Record { opcode, data }))) => {
                match recording.record(opcode, data).map_err(io)? {
                    Some(()) => {}
                    None => break Some("is damaged".to_owned()),
                }
            }
            Some(Some(Err(McapError::BadChunkCrc { .. }))) => damaged_chunks += 1,
            Some(Some(Err(McapError::UnexpectedEof))) => {
                break Some("has no end: the recorder was stopped, or the file was cut off".into());
            }
            Some(Some(Err(McapError::UnsupportedCompression(name)))) => {
                break Some(format!(
                    "uses what is not read (compression {})",
                    quoted(&name)
                ));
            }
            None | Some(Some(Err(_))) => break Some("is damaged".into()),
        }
    };
    let mut notices = Vec::new();
    let series = recording.finish(&mut notices);
    if series.is_empty() {
        let message = match (end, notices.first()) {
            (Some(end), None) => format!("{end}, expected a recording in MCAP"),
            (_, Some(notice)) => format!("found no topic with readings ({notice})"),
            (None, None) => "found no messages, expected readings".to_owned(),
        };
        return Err(ReadError::new(file, Place::File, message));
    }
    if let Some(end) = end {
        notices.push(format!("{end}; it is read as far as it goes"));
    }
    if damaged_chunks > 0 {
        notices.push(format!(
            "check sums of {damaged_chunks} of its chunks are wrong; their values may be, too"
        ));
    }
    Ok(Source {
        file: file.into(),
        format: Format::Mcap,
        series,
        notices: notices
            .into_iter()
            .map(|notice| format!("{file}: {notice}"))
            .collect(),
    })
}

/// What was read so far.
#[derive(Default)]
struct Recording {
    schemas: HashMap<u16, Schema>,
    connections: HashMap<u16, Kept>,
    topics: Vec<Topic>,
    storage: Storage,
    notices: Vec<String>,
}

struct Schema {
    name: String,
    encoding: String,
    text: String,
}

/// What becomes of the messages of a connection.
enum Kept {
    Topic(usize),
    /// Nothing; the notice that says why, until a message has come.
    LeftOut(Option<String>),
}

struct Topic {
    name: String,
    schema: u16,
    decoder: Decoder,
    layout: Layout,
    series: Vec<Rows>,
    /// Messages that do not fit their type.
    unread: usize,
    /// Frames beyond those that are kept.
    has_more_frames: bool,
}

enum Decoder {
    Cdr(Definitions),
    /// Transforms, of which each frame has a series.
    Transforms(Definitions, Kind),
    Json,
}

/// A series that is being filled.
#[derive(Default)]
struct Rows {
    name: String,
    /// The frame of transforms.
    frame: String,
    count: usize,
    time_s: Filling,
    numbers: Vec<Filling>,
    texts: Vec<Texts>,
}

#[derive(Default)]
struct Texts {
    all: FillingTexts,
    has_any: bool,
}

impl Recording {
    /// Takes a record; `None` where it is damaged.
    fn record(&mut self, opcode: u8, data: &[u8]) -> io::Result<Option<()>> {
        if ![op::SCHEMA, op::CHANNEL, op::MESSAGE].contains(&opcode) {
            return Ok(Some(()));
        }
        let Some(Ok(record)) = read_damaged(|| mcap::parse_record(opcode, data)) else {
            return Ok(None);
        };
        match record {
            Record::Schema { header, data } => {
                let schema = Schema {
                    name: header.name,
                    encoding: header.encoding,
                    text: String::from_utf8_lossy(&data).into_owned(),
                };
                self.schemas.entry(header.id).or_insert(schema);
            }
            Record::Channel(connection) => self.connect(connection),
            Record::Message { header, data } => self.message(&header, &data)?,
            _ => {}
        }
        Ok(Some(()))
    }

    /// Takes a connection; each chunk may repeat those of which it has messages.
    fn connect(&mut self, connection: Connection) {
        let Connection { id, topic, .. } = &connection;
        if self.connections.contains_key(id) {
            return;
        }
        // A topic with several publishers may have a connection for each.
        let is_same = |one: &Topic| one.name == *topic && one.schema == connection.schema_id;
        let kept = match self.topics.iter().position(is_same) {
            Some(place) => Kept::Topic(place),
            None => match self.decoder(&connection) {
                Ok(decoder) => {
                    self.topics.push(Topic {
                        name: topic.clone(),
                        schema: connection.schema_id,
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
        self.connections.insert(*id, kept);
    }

    /// How the messages of a connection are decoded; or why they are not.
    fn decoder(&self, connection: &Connection) -> Result<Decoder, String> {
        let schema = self.schemas.get(&connection.schema_id);
        let encoding = schema.map_or("", |schema| schema.encoding.as_str());
        match (connection.message_encoding.as_str(), encoding, schema) {
            ("json", _, _) => Ok(Decoder::Json),
            ("cdr", "ros2msg", Some(schema)) => {
                let definitions = Definitions::parse(&schema.name, &schema.text)?;
                if let Some(what) = no_reading(&definitions.message().name) {
                    return Err(what.into());
                }
                Ok(match definitions.transforms() {
                    Some(kind) => Decoder::Transforms(definitions, kind),
                    None => Decoder::Cdr(definitions),
                })
            }
            ("cdr", encoding, _) => Err(format!("messages whose type is in {}", named(encoding))),
            (encoding, _, _) => Err(format!("messages in {}", named(encoding))),
        }
    }

    fn message(&mut self, header: &MessageHeader, data: &[u8]) -> io::Result<()> {
        match self.connections.get_mut(&header.channel_id) {
            Some(Kept::Topic(place)) => {
                let log_s = seconds(header.log_time);
                self.topics[*place].message(data, log_s, &mut self.storage)
            }
            Some(Kept::LeftOut(notice)) => {
                self.notices.extend(notice.take());
                Ok(())
            }
            None => Ok(()),
        }
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
                    values: self.storage.finish(values),
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
                    time_s: Some(self.storage.finish(rows.time_s)),
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
    fn message(&mut self, data: &[u8], log_s: f64, storage: &mut Storage) -> io::Result<()> {
        let Self {
            decoder,
            layout,
            name,
            ..
        } = self;
        let read = match decoder {
            Decoder::Json => layout.read_json(data),
            Decoder::Cdr(definitions) => Cdr::new(data).and_then(|mut cdr| {
                let root = match definitions.is_only_data() {
                    true => name.trim_matches('/').replace('/', "."),
                    false => String::new(),
                };
                layout.read(definitions, Kind::Nested(0), &mut cdr, &root)
            }),
            Decoder::Transforms(definitions, kind) => {
                let Some(mut cdr) = Cdr::new(data) else {
                    self.unread += 1;
                    return Ok(());
                };
                for _ in 0..cdr.count().unwrap_or(0) {
                    if layout.read(definitions, *kind, &mut cdr, "").is_none() {
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
                    self.series[place].push(layout, log_s, storage)?;
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
        self.series[0].push(layout, log_s, storage)
    }
}

impl Rows {
    fn new(name: String, frame: &str, layout: &Layout) -> Self {
        let texts = layout.texts.iter();
        Self {
            name: name.replace(char::is_control, "?"),
            frame: frame.to_owned(),
            numbers: layout.columns.iter().map(|_| Filling::default()).collect(),
            texts: texts.map(|_| Texts::default()).collect(),
            ..Self::default()
        }
    }

    /// Adds the message that was read last.
    fn push(&mut self, layout: &Layout, log_s: f64, storage: &mut Storage) -> io::Result<()> {
        storage.push(&mut self.time_s, layout.stamp_s.unwrap_or(log_s))?;
        for (values, value) in self.numbers.iter_mut().zip(&layout.row) {
            storage.push(values, *value)?;
        }
        for (texts, text) in self.texts.iter_mut().zip(&layout.row_texts) {
            texts.all.push(text);
            texts.has_any |= !text.is_empty();
        }
        self.count += 1;
        Ok(())
    }
}

/// What messages hold that are known to have no readings.
fn no_reading(kind: &str) -> Option<&'static str> {
    match kind.split_once('/')? {
        ("rcl_interfaces" | "diagnostic_msgs", _) => Some("messages of the programs"),
        ("sensor_msgs", "Image" | "CompressedImage") => Some("images"),
        ("sensor_msgs", "PointCloud" | "PointCloud2") => Some("clouds of points"),
        _ => None,
    }
}

/// An encoding in sentences.
fn named(encoding: &str) -> String {
    match encoding {
        "" => "an encoding that is not named".to_owned(),
        encoding => format!("the encoding {}", quoted(encoding)),
    }
}

/// Seconds of nanoseconds, without losing some to the size of the number.
fn seconds(nanoseconds: u64) -> f64 {
    const SECOND: u64 = 1_000_000_000;
    (nanoseconds / SECOND) as f64 + (nanoseconds % SECOND) as f64 * 1e-9
}

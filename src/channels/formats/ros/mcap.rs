//! Recordings of ROS 2 in MCAP.

use std::collections::HashMap;
use std::io::{self, Read};

use mcap::McapError;
use mcap::records::{Channel as Connection, Record, op};
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};
use tautline_files::{Location, ReadError, quoted, read_damaged};

use super::definitions::{Definitions, Version};
use super::wire::Wire;
use super::{CUT_OFF, Decoder, Recording, longest_record};
use crate::input::Input;
use crate::source::{Format, Source};

/// Bytes read at a time.
const BLOCK: usize = 64 << 10;

pub fn read(input: &mut Input<'_>, file: &str) -> Result<Source, ReadError> {
    let io = |error: io::Error| ReadError::io(file, Location::File, &error);
    let bytes = input.file().and_then(|file| file.metadata()).map_err(io)?;
    let options = LinearReaderOptions::default()
        .with_validate_chunk_crcs(true)
        .with_record_length_limit(longest_record(bytes.len()) as usize);
    let mut reader = LinearReader::new_with_options(options);
    let mut records = Records {
        schemas: HashMap::new(),
        recording: Recording::within(input.budget()),
    };
    let mut damaged_chunks = 0_usize;
    let end = loop {
        // The third-party reader may panic on a damaged file.
        match read_damaged(|| reader.next_event()) {
            Some(None) => break None,
            Some(Some(Ok(LinearReadEvent::ReadRequest(_)))) => {
                let read = input.read(reader.insert(BLOCK)).map_err(io)?;
                reader.notify_read(read);
            }
            // Only the summary section follows.
            Some(Some(Ok(LinearReadEvent::Record { opcode, .. }))) if opcode == op::DATA_END => {
                break None;
            }
            Some(Some(Ok(LinearReadEvent::Record { opcode, data }))) => {
                match records.record(opcode, data).map_err(io)? {
                    Some(()) => {}
                    None => break Some("is damaged".to_owned()),
                }
            }
            Some(Some(Err(McapError::BadChunkCrc { .. }))) => damaged_chunks += 1,
            Some(Some(Err(McapError::UnexpectedEof))) => {
                break Some(CUT_OFF.into());
            }
            Some(Some(Err(McapError::UnsupportedCompression(name)))) => {
                break Some(format!(
                    "uses an unsupported compression ({})",
                    quoted(&name)
                ));
            }
            None | Some(Some(Err(_))) => break Some("is damaged".into()),
        }
    };
    let mut notices = Vec::new();
    if damaged_chunks > 0 {
        notices.push(format!(
            "the checksums of {damaged_chunks} of its chunks are wrong; their values may be wrong, too"
        ));
    }
    let recording = records.recording;
    recording.source(file, Format::Mcap, end, notices)
}

/// State of reading, with the message types.
struct Records {
    schemas: HashMap<u16, Schema>,
    recording: Recording,
}

struct Schema {
    name: String,
    encoding: String,
    text: String,
}

impl Records {
    /// Handles a record; `None` if it is damaged.
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
            Record::Channel(connection) => {
                let (id, kind) = (connection.id.into(), connection.schema_id.into());
                let decoder = || decoder(&self.schemas, &connection);
                self.recording.connect(id, &connection.topic, kind, decoder);
            }
            Record::Message { header, data } => {
                let log_s = seconds(header.log_time);
                self.recording
                    .message(header.channel_id.into(), log_s, &data)?;
            }
            _ => {}
        }
        Ok(Some(()))
    }
}

/// The decoder of the messages of a connection; the error states why there is none.
fn decoder(schemas: &HashMap<u16, Schema>, connection: &Connection) -> Result<Decoder, String> {
    let schema = schemas.get(&connection.schema_id);
    let encoding = schema.map_or("", |schema| schema.encoding.as_str());
    match (connection.message_encoding.as_str(), encoding, schema) {
        ("json", _, _) => Ok(Decoder::Json),
        ("cdr", "ros2msg", Some(schema)) => {
            let definitions = Definitions::parse(Version::Ros2, &schema.name, &schema.text)?;
            Decoder::typed(|data| Wire::cdr(data), definitions)
        }
        ("cdr", encoding, _) => Err(format!(
            "messages whose type is described in {}",
            named(encoding)
        )),
        (encoding, _, _) => Err(format!("messages in {}", named(encoding))),
    }
}

/// An encoding, for use in sentences.
fn named(encoding: &str) -> String {
    match encoding {
        "" => "an unnamed encoding".to_owned(),
        encoding => format!("the encoding {}", quoted(encoding)),
    }
}

/// Converts nanoseconds to seconds with full precision.
fn seconds(nanoseconds: u64) -> f64 {
    const SECOND: u64 = 1_000_000_000;
    (nanoseconds / SECOND) as f64 + (nanoseconds % SECOND) as f64 * 1e-9
}

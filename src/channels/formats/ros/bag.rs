//! ROS 1 bags, version 2.0: records of header and data, most of them in chunks that may be compressed.

use std::borrow::Cow;
use std::io::{self, BufReader, ErrorKind, Read};

use bzip2::read::BzDecoder;
use lz4_flex::frame::FrameDecoder;
use tautline_files::{Location, ReadError, quoted, read_damaged};

use super::definitions::{Definitions, Version};
use super::wire::Wire;
use super::{CUT_OFF, Decoder, RECORD, Recording, longest_record};
use crate::input::Input;
use crate::source::{Format, Source};

/// Magic number of a bag.
const BEGIN: &[u8] = b"#ROSBAG V2.0\n";
/// Longest header of a record (bytes): it has a few short fields.
const LONGEST_HEADER: u64 = 1 << 20;
const DAMAGED: &str = "is damaged";

/// Record types by the field `op` of the header; other records belong to the index.
mod op {
    pub const MESSAGE: &[u8] = &[2];
    pub const BAG: &[u8] = &[3];
    pub const CHUNK: &[u8] = &[5];
    pub const CONNECTION: &[u8] = &[7];
}

pub fn read(input: &mut Input<'_>, file: &str) -> Result<Source, ReadError> {
    let failed = |error: io::Error| ReadError::io(file, Location::File, &error);
    let size = input.file().and_then(|file| file.metadata());
    let mut bag = Bag {
        size: size.map_err(failed)?.len(),
        recording: Recording::within(input.budget()),
        types: Vec::new(),
        index_at: 0,
        is_encrypted: false,
        damaged_chunks: 0,
    };
    let mut input = BufReader::new(input);
    let mut begin = [0; BEGIN.len()];
    input.read_exact(&mut begin).map_err(failed)?;
    let end = loop {
        match record(&mut input) {
            Ok(Some((header, data))) => match bag.record(&header, &data).map_err(failed)? {
                Ok(()) => {}
                Err(end) => break Some(end),
            },
            Ok(None) => break bag.is_open().then(|| CUT_OFF.to_owned()),
            Err(error) => match error.kind() {
                ErrorKind::UnexpectedEof => break Some(CUT_OFF.to_owned()),
                // A recorder that was stopped had not yet written the lengths of its last chunk.
                ErrorKind::InvalidData if bag.is_open() => break Some(CUT_OFF.to_owned()),
                ErrorKind::InvalidData => break Some(DAMAGED.to_owned()),
                _ => return Err(failed(error)),
            },
        }
        if bag.is_encrypted {
            let message = "is an encrypted bag, expected one that is not (rosbag decrypt <bag>)";
            return Err(ReadError::new(file, Location::File, message));
        }
    };
    let mut notices = Vec::new();
    if bag.damaged_chunks > 0 {
        notices.push(format!(
            "{} of its chunks are damaged; their messages are read as far as possible and may be wrong",
            bag.damaged_chunks
        ));
    }
    bag.recording.source(file, Format::RosBag, end, notices)
}

/// State of reading.
struct Bag {
    recording: Recording,
    /// Names and checksums of the message types.
    types: Vec<(String, Vec<u8>)>,
    /// Bytes of the file.
    size: u64,
    /// Offset of the index; 0 until the recorder has closed the bag.
    index_at: u64,
    is_encrypted: bool,
    damaged_chunks: usize,
}

impl Bag {
    /// Whether the bag was not closed by the recorder, or is cut off before its index.
    fn is_open(&self) -> bool {
        self.index_at == 0 || self.index_at > self.size
    }

    /// Handles a record of the file; the inner error states how the recording ends.
    fn record(&mut self, header: &[u8], data: &[u8]) -> io::Result<Result<(), String>> {
        let read = match field(header, "op") {
            Some(op::BAG) => self.begin(header),
            Some(op::CHUNK) => return self.chunk(header, data),
            Some(_) => self.inner(header, data)?,
            None => None,
        };
        Ok(read.ok_or_else(|| DAMAGED.to_owned()))
    }

    /// Takes the header of the bag.
    fn begin(&mut self, header: &[u8]) -> Option<()> {
        self.index_at = u64::from_le_bytes(field(header, "index_pos")?.try_into().ok()?);
        self.is_encrypted = field(header, "encryptor").is_some_and(|name| !name.is_empty());
        Some(())
    }

    /// Takes the records of a chunk.
    fn chunk(&mut self, header: &[u8], data: &[u8]) -> io::Result<Result<(), String>> {
        let (Some(size), Some(compression)) = (
            field(header, "size").and_then(number),
            field(header, "compression"),
        ) else {
            return Ok(Err(DAMAGED.to_owned()));
        };
        // A chunk still being written has no length; its records follow.
        if data.is_empty() {
            return Ok(Ok(()));
        }
        let most = u64::from(size).min(longest_record(self.size));
        let (content, is_intact) = match compression {
            b"none" => (Cow::Borrowed(data), true),
            b"bz2" => decompressed(BzDecoder::new(data), most),
            b"lz4" => decompressed(FrameDecoder::new(data), most),
            other => {
                let name = quoted(&String::from_utf8_lossy(other));
                return Ok(Err(format!("uses an unsupported compression ({name})")));
            }
        };
        let mut is_whole = is_intact && content.len() as u64 == u64::from(size);
        let mut rest = &content[..];
        while !rest.is_empty() {
            let record = counted(&mut rest).zip(counted(&mut rest));
            let read = match record {
                Some((header, data)) => self.inner(header, data)?,
                None => None,
            };
            if read.is_none() {
                is_whole = false;
                break;
            }
        }
        self.damaged_chunks += usize::from(!is_whole);
        Ok(Ok(()))
    }

    /// Takes a record that is not a chunk; `None` where it is damaged.
    fn inner(&mut self, header: &[u8], data: &[u8]) -> io::Result<Option<()>> {
        Ok(match field(header, "op") {
            Some(op::CONNECTION) => self.connect(header, data),
            Some(op::MESSAGE) => match message(header) {
                Some((id, time_s)) => Some(self.recording.message(id, time_s, data)?),
                None => None,
            },
            op => op.map(|_| ()),
        })
    }

    /// Takes a connection: its topic, and the type of its messages.
    fn connect(&mut self, header: &[u8], data: &[u8]) -> Option<()> {
        let id = number(field(header, "conn")?)?;
        let topic = String::from_utf8_lossy(field(header, "topic")?);
        let name = String::from_utf8_lossy(field(data, "type")?);
        let sum = field(data, "md5sum").unwrap_or_default();
        let is_same = |(known, its_sum): &(String, Vec<u8>)| *known == name && its_sum == sum;
        let kind = match self.types.iter().position(is_same) {
            Some(kind) => kind,
            None => {
                self.types.push((name.to_string(), sum.to_vec()));
                self.types.len() - 1
            }
        };
        let decoder = || {
            let text = field(data, "message_definition").unwrap_or_default();
            if text.is_empty() {
                return Err(format!(
                    "messages of the type {}, whose fields are unknown",
                    quoted(&name)
                ));
            }
            let text = String::from_utf8_lossy(text);
            let definitions = Definitions::parse(Version::Ros1, &name, &text)?;
            Decoder::typed(|data| Some(Wire::ros_1(data)), definitions)
        };
        self.recording.connect(id, &topic, kind as u32, decoder);
        Some(())
    }
}

/// Header and data of the next record; none at the end.
fn record(input: &mut impl Read) -> io::Result<Option<(Vec<u8>, Vec<u8>)>> {
    let mut first = [0];
    if input.read(&mut first)? == 0 {
        return Ok(None);
    }
    let mut others = [0; 3];
    input.read_exact(&mut others)?;
    let length = u32::from_le_bytes([first[0], others[0], others[1], others[2]]);
    let header = part(input, length, LONGEST_HEADER)?;
    let mut length = [0; 4];
    input.read_exact(&mut length)?;
    let data = part(input, u32::from_le_bytes(length), RECORD[1])?;
    Ok(Some((header, data)))
}

/// Reads `length` bytes, allocating only as they arrive.
fn part(input: &mut impl Read, length: u32, most: u64) -> io::Result<Vec<u8>> {
    let length = u64::from(length);
    if length > most {
        return Err(ErrorKind::InvalidData.into());
    }
    let mut bytes = Vec::new();
    input.take(length).read_to_end(&mut bytes)?;
    if (bytes.len() as u64) < length {
        return Err(ErrorKind::UnexpectedEof.into());
    }
    Ok(bytes)
}

/// Decompresses at most `most` bytes plus one, and returns whether they are intact: reading the extra byte verifies the
/// checksum.
fn decompressed(reader: impl Read, most: u64) -> (Cow<'static, [u8]>, bool) {
    let mut bytes = Vec::new();
    let mut reader = reader.take(most + 1);
    // Third-party decompressors may panic on a damaged file.
    let read = read_damaged(|| reader.read_to_end(&mut bytes));
    (bytes.into(), matches!(read, Some(Ok(_))))
}

/// Bytes preceded by their number.
fn counted<'a>(bytes: &mut &'a [u8]) -> Option<&'a [u8]> {
    let (count, rest) = bytes.split_first_chunk::<4>()?;
    let count = usize::try_from(u32::from_le_bytes(*count)).ok()?;
    let (part, rest) = rest.split_at_checked(count)?;
    *bytes = rest;
    Some(part)
}

/// The value of a field `name=value`.
fn field<'a>(mut header: &'a [u8], name: &str) -> Option<&'a [u8]> {
    loop {
        let value = counted(&mut header)?.strip_prefix(name.as_bytes());
        if let Some(value) = value.and_then(|value| value.strip_prefix(b"=")) {
            return Some(value);
        }
    }
}

fn number(value: &[u8]) -> Option<u32> {
    Some(u32::from_le_bytes(value.try_into().ok()?))
}

/// Connection of a message, and when it was recorded (s).
fn message(header: &[u8]) -> Option<(u32, f64)> {
    let id = number(field(header, "conn")?)?;
    let (seconds, nanoseconds) = field(header, "time")?.split_at_checked(4)?;
    let time_s = f64::from(number(seconds)?) + f64::from(number(nanoseconds)?) * 1e-9;
    Some((id, time_s))
}

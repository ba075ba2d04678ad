//! Measurement files of test benches and cars in MDF 4 (`.mf4`): blocks that link to each other by their places in the file.
//!
//! Source: ASAM, "MDF, Measurement Data Format", version 4.1. A data group has records of channel groups; a channel states where
//! its bits are in a record, and how they convert to physical values.

use std::io::Read;

use flate2::read::ZlibDecoder;
use tautline_files::{Location, ReadError, quoted};

use super::fault::Fault;
use super::{over_budget, stem, whole};
use crate::input::Input;
use crate::memory::MemoryBudget;
use crate::source::{Channel, Format, Series, Source};

/// First bytes of a file, and of one that was not closed.
pub(super) const BEGIN: [&[u8]; 2] = [b"MDF     ", b"UnFinMF "];
/// Place of the first block.
const HEADER: u64 = 64;
/// Bytes of the head of a block.
const HEAD: u64 = 24;
/// Most blocks in one list: more are links in a circle.
const MOST_BLOCKS: usize = 1 << 20;

pub(super) fn read(mut input: Input<'_>, file: &str) -> Result<Source, ReadError> {
    let bytes = whole(&mut input, file)?;
    let fail = |message: String| ReadError::new(file, Location::File, message);
    let version = String::from_utf8_lossy(bytes.get(8..16).unwrap_or_default());
    if !version.starts_with('4') {
        let version = version.trim_matches(|letter: char| letter.is_whitespace() || letter == '\0');
        return Err(fail(format!(
            "is MDF of version {}, expected 4.0 or later (asammdf, or the export of the recorder, converts it)",
            quoted(version)
        )));
    }
    let mut recording = Recording {
        bytes: &bytes,
        budget: input.budget(),
        series: Vec::new(),
        notices: Vec::new(),
    };
    match recording.groups(&stem(file)) {
        Ok(()) => {}
        Err(Fault::Large(over)) => return Err(over_budget(file, over)),
        Err(Fault::Damaged) if !recording.series.is_empty() => {
            let notice = "is damaged or cut off; read as far as possible";
            recording.notices.push(notice.to_owned());
        }
        Err(Fault::Damaged) => return Err(fail("is damaged, expected MDF 4".into())),
    }
    let Recording {
        series, notices, ..
    } = recording;
    if series.is_empty() {
        return Err(fail(
            "found no channel with numbers, expected readings".into(),
        ));
    }
    Ok(Source {
        file: file.into(),
        format: Format::Mdf,
        series,
        notices: notices
            .into_iter()
            .map(|notice| format!("{file}: {notice}"))
            .collect(),
    })
}

/// A block: its links and its data.
struct Block<'a> {
    kind: [u8; 4],
    links: Vec<u64>,
    data: &'a [u8],
}

impl Block<'_> {
    /// The place that a link names; `None` if it is absent or empty.
    fn link(&self, k: usize) -> Option<u64> {
        self.links.get(k).copied().filter(|place| *place != 0)
    }

    fn u8(&self, at: usize) -> Result<u8, Fault> {
        self.data.get(at).copied().ok_or(Fault::Damaged)
    }

    fn u16(&self, at: usize) -> Result<u16, Fault> {
        Ok(u16::from_le_bytes(array(self.data, at)?))
    }

    fn u32(&self, at: usize) -> Result<u32, Fault> {
        Ok(u32::from_le_bytes(array(self.data, at)?))
    }

    fn u64(&self, at: usize) -> Result<u64, Fault> {
        Ok(u64::from_le_bytes(array(self.data, at)?))
    }

    fn f64(&self, at: usize) -> Result<f64, Fault> {
        Ok(f64::from_le_bytes(array(self.data, at)?))
    }
}

fn array<const N: usize>(bytes: &[u8], at: usize) -> Result<[u8; N], Fault> {
    let end = at.checked_add(N).ok_or(Fault::Damaged)?;
    let bytes = bytes.get(at..end).ok_or(Fault::Damaged)?;
    bytes.try_into().map_err(|_| Fault::Damaged)
}

/// Layout of the records of a channel group.
struct ChannelGroup {
    id: u64,
    /// Bytes of a record without its record number, including the invalidation bits.
    bytes: usize,
    data_bytes: usize,
    /// Whether the records are variable-length texts.
    has_texts: bool,
    acquisition: Option<String>,
    channels: Vec<ChannelLayout>,
}

/// A channel in a record.
struct ChannelLayout {
    name: String,
    unit: Option<String>,
    is_time: bool,
    /// A master channel without bits counts the records.
    is_virtual: bool,
    number: Number,
    big_endian: bool,
    byte: usize,
    bit: u32,
    bits: u32,
    /// Bit of its invalidity behind the data of a record.
    invalid: Option<usize>,
    conversion: Conversion,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Number {
    Unsigned,
    Signed,
    Float,
}

/// Conversion of a stored number into a physical value.
enum Conversion {
    Linear([f64; 2]),
    Rational([f64; 6]),
    Table {
        points: Vec<[f64; 2]>,
        interpolates: bool,
    },
}

impl Conversion {
    const NONE: Self = Self::Linear([0.0, 1.0]);

    fn apply(&self, raw: f64) -> f64 {
        match self {
            Self::Linear([offset, factor]) => offset + factor * raw,
            Self::Rational([a, b, c, d, e, f]) => {
                (a * raw * raw + b * raw + c) / (d * raw * raw + e * raw + f)
            }
            Self::Table {
                points,
                interpolates,
            } => table(points, *interpolates, raw),
        }
    }
}

fn table(points: &[[f64; 2]], interpolates: bool, raw: f64) -> f64 {
    let (Some(first), Some(last)) = (points.first(), points.last()) else {
        return f64::NAN;
    };
    if raw <= first[0] || raw.is_nan() {
        return first[1];
    }
    let Some(next) = points.iter().position(|point| point[0] >= raw) else {
        return last[1];
    };
    let ([x0, y0], [x1, y1]) = (points[next - 1], points[next]);
    let part = (raw - x0) / (x1 - x0);
    match interpolates {
        true => y0 + part * (y1 - y0),
        false if part < 0.5 => y0,
        false => y1,
    }
}

struct Recording<'a> {
    bytes: &'a [u8],
    budget: &'a MemoryBudget,
    series: Vec<Series>,
    notices: Vec<String>,
}

impl<'a> Recording<'a> {
    fn block(&self, at: u64) -> Result<Block<'a>, Fault> {
        let at = usize::try_from(at).map_err(|_| Fault::Damaged)?;
        let mark: [u8; 4] = array(self.bytes, at)?;
        let length = u64::from_le_bytes(array(self.bytes, at + 8)?);
        let count = u64::from_le_bytes(array(self.bytes, at + 16)?);
        let body = HEAD.checked_add(count.checked_mul(8).ok_or(Fault::Damaged)?);
        let body = body.filter(|body| *body <= length).ok_or(Fault::Damaged)?;
        let [body, length] =
            [body, length].map(|bytes| usize::try_from(bytes).unwrap_or(usize::MAX));
        let end = at.saturating_add(length).min(self.bytes.len());
        let whole = self.bytes.get(at..end).ok_or(Fault::Damaged)?;
        let links = whole.get(HEAD as usize..body).ok_or(Fault::Damaged)?;
        let (links, _) = links.as_chunks::<8>();
        Ok(Block {
            kind: mark,
            links: links.iter().map(|link| u64::from_le_bytes(*link)).collect(),
            data: &whole[body..],
        })
    }

    /// The blocks of a list of which each links to the next.
    fn list(&self, first: Option<u64>, kind: &[u8; 4]) -> Result<Vec<Block<'a>>, Fault> {
        let mut blocks = Vec::new();
        let mut next = first;
        while let Some(at) = next {
            let block = self.block(at)?;
            if block.kind != *kind || blocks.len() > MOST_BLOCKS {
                return Err(Fault::Damaged);
            }
            next = block.link(0);
            blocks.push(block);
        }
        Ok(blocks)
    }

    /// A text; that of a comment in XML is what its element `TX` contains.
    fn text(&self, at: Option<u64>) -> Option<String> {
        let block = self.block(at?).ok()?;
        let text = String::from_utf8_lossy(block.data);
        let text = text.trim_end_matches('\0').trim();
        let text = match &block.kind {
            b"##MD" => text.split_once("<TX>")?.1.split_once("</TX>")?.0,
            b"##TX" => text,
            _ => return None,
        };
        Some(text.to_owned()).filter(|text| !text.is_empty())
    }

    fn groups(&mut self, name: &str) -> Result<(), Fault> {
        let header = self.block(HEADER)?;
        if header.kind != *b"##HD" {
            return Err(Fault::Damaged);
        }
        for group in self.list(header.link(0), b"##DG")? {
            let id_bytes = usize::from(group.u8(0)?);
            let mut channel_groups = Vec::new();
            for block in self.list(group.link(1), b"##CG")? {
                channel_groups.push(self.channel_group(&block)?);
            }
            let Some(data) = group.link(2) else {
                continue;
            };
            let records = self.data(data, &self.budget.temporary())?;
            self.records(&records, id_bytes, channel_groups, name)?;
        }
        Ok(())
    }

    fn channel_group(&mut self, block: &Block<'_>) -> Result<ChannelGroup, Fault> {
        let flags = block.u16(16)?;
        let [data, invalid] = [block.u32(24)?, block.u32(28)?];
        let mut group = ChannelGroup {
            id: block.u64(0)?,
            bytes: data as usize + invalid as usize,
            data_bytes: data as usize,
            has_texts: flags & 1 != 0,
            acquisition: self.text(block.link(2)),
            channels: Vec::new(),
        };
        if group.has_texts {
            return Ok(group);
        }
        for channel in self.list(block.link(1), b"##CN")? {
            let name = self.text(channel.link(2)).unwrap_or_default();
            if channel.link(1).is_some() {
                self.notices
                    .push(format!("channel {} has parts, left out", quoted(&name)));
                continue;
            }
            match self.channel(&channel, name.clone())? {
                Ok(channel) => group.channels.push(channel),
                Err(why) => {
                    self.notices
                        .push(format!("channel {} {why}, left out", quoted(&name)));
                }
            }
        }
        Ok(group)
    }

    /// The inner error states why a channel cannot be used.
    fn channel(
        &self,
        block: &Block<'_>,
        name: String,
    ) -> Result<Result<ChannelLayout, &'static str>, Fault> {
        let kind = block.u8(0)?;
        let [sync, data] = [block.u8(1)?, block.u8(2)?];
        let (bit, bits) = (u32::from(block.u8(3)?), block.u32(8)?);
        let flags = block.u32(12)?;
        let is_virtual = matches!(kind, 3 | 6);
        if matches!(kind, 1 | 4 | 5) {
            return Ok(Err("has texts or other data of its own"));
        }
        let (number, big_endian) = match data {
            0 | 1 => (Number::Unsigned, data == 1),
            2 | 3 => (Number::Signed, data == 3),
            4 | 5 => (Number::Float, data == 5),
            _ => return Ok(Err("has no numbers")),
        };
        let is_sized = match number {
            Number::Float => bit == 0 && matches!(bits, 32 | 64),
            _ => (1..=64).contains(&bits) && bit < 8 && bit + bits <= 64,
        };
        if !(is_sized || is_virtual) || big_endian && (bit != 0 || bits % 8 != 0) {
            return Ok(Err("has numbers of an unsupported size"));
        }
        let conversion = match block.link(4) {
            None => Conversion::NONE,
            Some(at) => match self.conversion(&self.block(at)?)? {
                Some(conversion) => conversion,
                None => return Ok(Err("has an unsupported conversion")),
            },
        };
        let of_conversion = block.link(4).and_then(|at| self.block(at).ok());
        let unit = self.text(block.link(6));
        let unit = unit.or_else(|| self.text(of_conversion?.link(1)));
        Ok(Ok(ChannelLayout {
            is_time: matches!(kind, 2 | 3) && sync == 1,
            is_virtual,
            number,
            big_endian,
            byte: block.u32(4)? as usize,
            bit,
            bits,
            invalid: (flags & 2 != 0).then_some(block.u32(16)? as usize),
            conversion,
            unit: unit.or_else(|| (matches!(kind, 2 | 3) && sync == 1).then(|| "s".to_owned())),
            name,
        }))
    }

    /// `None` if a conversion is not supported; texts for values leave them as they are.
    fn conversion(&self, block: &Block<'_>) -> Result<Option<Conversion>, Fault> {
        let kind = block.u8(0)?;
        let count = usize::from(block.u16(6)?);
        let value = |k: usize| block.f64(24 + 8 * k);
        Ok(match kind {
            0 | 7 | 8 => Some(Conversion::NONE),
            1 => Some(Conversion::Linear([value(0)?, value(1)?])),
            2 => {
                let all = [
                    value(0)?,
                    value(1)?,
                    value(2)?,
                    value(3)?,
                    value(4)?,
                    value(5)?,
                ];
                Some(Conversion::Rational(all))
            }
            4 | 5 => {
                let points = (0..count / 2).map(|k| Ok([value(2 * k)?, value(2 * k + 1)?]));
                Some(Conversion::Table {
                    points: points.collect::<Result<_, Fault>>()?,
                    interpolates: kind == 4,
                })
            }
            _ => None,
        })
    }

    /// The bytes of a data block, of a compressed one, or of a list of them.
    fn data(&self, at: u64, budget: &MemoryBudget) -> Result<Vec<u8>, Fault> {
        let mut all = Vec::new();
        let mut next = Some(at);
        let mut count = 0;
        while let Some(at) = next.take() {
            let block = self.block(at)?;
            match &block.kind {
                b"##HL" => next = block.link(0),
                b"##DL" => {
                    for place in block.links.iter().skip(1).filter(|place| **place != 0) {
                        self.part(&self.block(*place)?, budget, &mut all)?;
                    }
                    next = block.link(0);
                }
                _ => self.part(&block, budget, &mut all)?,
            }
            count += 1;
            if count > MOST_BLOCKS {
                return Err(Fault::Damaged);
            }
        }
        Ok(all)
    }

    /// Adds the bytes of a block. They count in a budget, since lists may name the same block many times.
    fn part(
        &self,
        block: &Block<'_>,
        budget: &MemoryBudget,
        all: &mut Vec<u8>,
    ) -> Result<(), Fault> {
        match &block.kind {
            b"##DT" => {
                budget.take(2 * block.data.len() as u64)?;
                all.extend_from_slice(block.data);
            }
            b"##DZ" => {
                let (method, width) = (block.u8(2)?, block.u32(4)? as usize);
                let length = block.u64(8)?;
                let packed = block.data.get(24..).ok_or(Fault::Damaged)?;
                let bytes = budget.read_to_end(ZlibDecoder::new(packed).take(length))?;
                match method {
                    0 => all.extend(bytes),
                    1 if width > 0 => all.extend(transposed(&bytes, width)),
                    _ => return Err(Fault::Damaged),
                }
            }
            _ => return Err(Fault::Damaged),
        }
        Ok(())
    }

    /// Adds the series of the channel groups of a data group.
    fn records(
        &mut self,
        bytes: &[u8],
        id_bytes: usize,
        groups: Vec<ChannelGroup>,
        name: &str,
    ) -> Result<(), Fault> {
        if id_bytes > 8 {
            return Err(Fault::Damaged);
        }
        let mut columns: Vec<Vec<Vec<f64>>> = groups
            .iter()
            .map(|group| vec![Vec::new(); group.channels.len()])
            .collect();
        let mut rest = bytes;
        while rest.len() > id_bytes {
            let (id, body) = rest.split_at(id_bytes);
            let mut wide = [0; 8];
            wide[..id_bytes].copy_from_slice(id);
            let id = u64::from_le_bytes(wide);
            let place = match id_bytes {
                0 => 0,
                _ => groups
                    .iter()
                    .position(|group| group.id == id)
                    .ok_or(Fault::Damaged)?,
            };
            let Some(group) = groups.get(place) else {
                return Ok(());
            };
            let length = match group.has_texts {
                true => 4 + u32::from_le_bytes(array(body, 0)?) as usize,
                false => group.bytes,
            };
            if length == 0 {
                return Err(Fault::Damaged);
            }
            let Some((record, next)) = body.split_at_checked(length) else {
                self.notices
                    .push("ends within a record: the recording was cut off".to_owned());
                break;
            };
            // Channels may be bits of the same byte.
            self.budget.take_values(group.channels.len())?;
            for (values, channel) in columns[place].iter_mut().zip(&group.channels) {
                let value = channel.value(record, group.data_bytes, values.len());
                values.push(value.ok_or(Fault::Damaged)?);
            }
            rest = next;
        }
        for (group, columns) in groups.into_iter().zip(columns) {
            self.add(group, columns, name);
        }
        Ok(())
    }

    fn add(&mut self, group: ChannelGroup, columns: Vec<Vec<f64>>, name: &str) {
        let rows = columns.first().map_or(0, Vec::len);
        if rows == 0 {
            return;
        }
        let mut series = Series {
            name: match (&group.acquisition, self.series.len()) {
                (Some(acquisition), _) => format!("{name} {acquisition}"),
                (None, 0) => name.to_owned(),
                (None, count) => format!("{name} {}", count + 1),
            },
            rows,
            ..Series::default()
        };
        for (channel, values) in group.channels.into_iter().zip(columns) {
            if channel.is_time && series.time_s.is_none() {
                series.time_s = Some(values.into());
                continue;
            }
            series.channels.push(Channel {
                name: channel.name,
                unit: channel.unit,
                values: values.into(),
            });
        }
        if !series.channels.is_empty() {
            self.series.push(series);
        }
    }
}

impl ChannelLayout {
    /// The physical value in a record; `None` if the record is too short.
    fn value(&self, record: &[u8], data_bytes: usize, row: usize) -> Option<f64> {
        if let Some(bit) = self.invalid {
            let byte = record.get(data_bytes + bit / 8)?;
            if byte >> (bit % 8) & 1 != 0 {
                return Some(f64::NAN);
            }
        }
        if self.is_virtual {
            return Some(self.conversion.apply(row as f64));
        }
        let count = (self.bit + self.bits).div_ceil(8) as usize;
        let own = record.get(self.byte..self.byte.checked_add(count)?)?;
        let mut wide = [0; 8];
        for (k, to) in wide.iter_mut().take(count).enumerate() {
            *to = own[if self.big_endian { count - 1 - k } else { k }];
        }
        let word = u64::from_le_bytes(wide) >> self.bit;
        let unused = 64 - self.bits;
        let raw = match self.number {
            Number::Float if self.bits == 32 => f32::from_bits(word as u32).into(),
            Number::Float => f64::from_bits(word),
            Number::Unsigned => (word << unused >> unused) as f64,
            Number::Signed => ((word << unused).cast_signed() >> unused) as f64,
        };
        Some(self.conversion.apply(raw))
    }
}

/// Bytes that were stored column by column for better compression; the rest behind the last whole row is as it was.
fn transposed(bytes: &[u8], width: usize) -> Vec<u8> {
    let rows = bytes.len() / width;
    let (matrix, rest) = bytes.split_at(rows * width);
    let in_rows =
        (0..rows).flat_map(|row| (0..width).map(move |column| matrix[column * rows + row]));
    in_rows.chain(rest.iter().copied()).collect()
}

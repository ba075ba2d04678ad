//! Measurement files of LabVIEW and DIAdem in TDMS: segments, each with the objects that changed, and their raw values.
//!
//! Source: NI, "TDMS File Format Internal Structure". An object is a group or a channel of it, with properties; the index of its raw
//! data is new, that of the segment before, or absent. The raw data of a segment are chunks that repeat until its end.

use std::collections::BTreeMap;

use tautline_files::{Location, ReadError, quoted};

use super::{stem, whole};
use crate::input::Input;
use crate::source::{Channel, Format, Series, Source};

/// First bytes of a segment.
pub(super) const BEGIN: &[u8] = b"TDSm";
/// Bytes of the head of a segment.
const LEAD_IN: u64 = 28;
/// Length of a segment that the recorder did not close.
const OPEN: u64 = u64::MAX;
/// Index of an object without raw data in a segment, and of one with the index of the segment before.
const NO_DATA: u32 = 0xffff_ffff;
const AS_BEFORE: u32 = 0;
/// Indices of raw data of DAQmx devices, which are scaled by their drivers.
const DAQMX: [u32; 2] = [0x1269, 0x126a];
const OF_DAQMX: &str =
    "has raw data of DAQmx devices, expected a file saved with scaled data (in DIAdem or LabVIEW)";
/// Most objects of a segment, and properties of an object.
const MOST_OBJECTS: u32 = 10_000;

/// Bits of the table of contents of a segment.
mod content {
    pub const META_DATA: u32 = 1 << 1;
    pub const NEW_OBJECTS: u32 = 1 << 2;
    pub const RAW_DATA: u32 = 1 << 3;
    pub const INTERLEAVED: u32 = 1 << 5;
    pub const BIG_ENDIAN: u32 = 1 << 6;
    pub const DAQMX: u32 = 1 << 7;
}

/// Reason why reading ended.
enum Fault {
    Damaged(&'static str),
    Refused(String),
}

pub(super) fn read(mut input: Input<'_>, file: &str) -> Result<Source, ReadError> {
    let bytes = whole(&mut input, file)?;
    let mut recording = Recording {
        objects: Vec::new(),
        active: Vec::new(),
        notices: Vec::new(),
    };
    let fail = |message: String| ReadError::new(file, Location::File, message);
    match recording.segments(&bytes) {
        Ok(()) => {}
        Err(Fault::Damaged(_)) if recording.has_values() => {
            let notice = "is damaged or cut off; read as far as possible";
            recording.notices.push(notice.to_owned());
        }
        Err(Fault::Damaged(what)) => {
            return Err(fail(format!("is damaged ({what}), expected TDMS")));
        }
        Err(Fault::Refused(message)) => return Err(fail(message)),
    }
    let (series, notices) = recording.finish(&stem(file));
    if series.is_empty() {
        return Err(fail(
            "found no channel with numbers, expected readings".into(),
        ));
    }
    Ok(Source {
        file: file.into(),
        format: Format::Tdms,
        series,
        notices: notices
            .into_iter()
            .map(|notice| format!("{file}: {notice}"))
            .collect(),
    })
}

/// Types of values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum DataType {
    Signed(u8),
    Unsigned(u8),
    Float(u8),
    Boolean,
    Text,
    Time,
}

impl DataType {
    fn of(code: u32) -> Option<Self> {
        Some(match code {
            1 => Self::Signed(1),
            2 => Self::Signed(2),
            3 => Self::Signed(4),
            4 => Self::Signed(8),
            5 => Self::Unsigned(1),
            6 => Self::Unsigned(2),
            7 => Self::Unsigned(4),
            8 => Self::Unsigned(8),
            9 | 0x19 => Self::Float(4),
            10 | 0x1a => Self::Float(8),
            0x20 => Self::Text,
            0x21 => Self::Boolean,
            0x44 => Self::Time,
            _ => return None,
        })
    }

    /// Bytes of a value; texts differ.
    fn size(self) -> Option<usize> {
        match self {
            Self::Signed(size) | Self::Unsigned(size) | Self::Float(size) => Some(size.into()),
            Self::Boolean => Some(1),
            Self::Time => Some(16),
            Self::Text => None,
        }
    }

    /// The number of these bytes, as many as [`Self::size`].
    fn number(self, bytes: &[u8], big_endian: bool) -> f64 {
        let mut wide = [0; 8];
        let ordered = |bytes: &[u8], wide: &mut [u8; 8]| {
            for (to, from) in wide.iter_mut().zip(0..bytes.len().min(8)) {
                *to = match big_endian {
                    true => bytes[bytes.len() - 1 - from],
                    false => bytes[from],
                };
            }
        };
        ordered(bytes, &mut wide);
        let word = u64::from_le_bytes(wide);
        match self {
            Self::Float(4) => f32::from_bits(word as u32).into(),
            Self::Float(_) => f64::from_bits(word),
            Self::Signed(size) => {
                let unused = 64 - 8 * u32::from(size);
                ((word << unused).cast_signed() >> unused) as f64
            }
            Self::Unsigned(_) | Self::Boolean => word as f64,
            // Fractions of 2^-64 s and seconds since 1904; big-endian files have the seconds first.
            Self::Time => {
                let (low, high) = bytes.split_at(8);
                let (fractions, seconds) = if big_endian { (high, low) } else { (low, high) };
                let mut part = [0; 8];
                ordered(fractions, &mut part);
                ordered(seconds, &mut wide);
                let whole = u64::from_le_bytes(wide).cast_signed() as f64;
                whole + u64::from_le_bytes(part) as f64 / 2.0_f64.powi(64)
            }
            Self::Text => f64::NAN,
        }
    }
}

/// Value of a property.
#[derive(Debug, Clone, PartialEq)]
enum Property {
    Number(f64),
    Text(String),
}

/// Raw data of an object in a chunk.
#[derive(Debug, Clone, Copy)]
struct Index {
    kind: DataType,
    count: u64,
    /// Bytes of all texts with their offsets; 0 for numbers.
    bytes: u64,
}

impl Index {
    fn bytes(&self) -> Option<u64> {
        match self.kind.size() {
            Some(size) => self.count.checked_mul(size as u64),
            None => Some(self.bytes),
        }
    }
}

/// A group or a channel.
struct Object {
    /// Names of the group and the channel.
    path: Vec<String>,
    index: Option<Index>,
    properties: BTreeMap<String, Property>,
    values: Vec<f64>,
    has_texts: bool,
}

struct Recording {
    objects: Vec<Object>,
    /// Objects with raw data in the current segment, in their order.
    active: Vec<usize>,
    notices: Vec<String>,
}

impl Recording {
    fn has_values(&self) -> bool {
        self.objects.iter().any(|object| !object.values.is_empty())
    }

    fn segments(&mut self, bytes: &[u8]) -> Result<(), Fault> {
        let mut at = 0_u64;
        while at + LEAD_IN <= bytes.len() as u64 {
            let from = usize::try_from(at).map_err(|_| Fault::Damaged("segment"))?;
            let mut lead = Reader {
                bytes: &bytes[from..],
                big_endian: false,
            };
            if lead.take(4)? != BEGIN {
                return Err(Fault::Damaged("segment"));
            }
            // The mask itself is always little-endian.
            let mask = lead.u32()?;
            lead.big_endian = mask & content::BIG_ENDIAN != 0;
            let _version = lead.u32()?;
            let (length, raw_at) = (lead.u64()?, lead.u64()?);
            let rest = bytes.len() as u64 - at - LEAD_IN;
            let length = if length == OPEN { rest } else { length };
            if length > rest {
                self.notices
                    .push("ends within a segment: the recording was cut off".to_owned());
            }
            let length = length.min(rest);
            let body = &bytes[from + LEAD_IN as usize..][..length as usize];
            let raw_at = usize::try_from(raw_at)
                .ok()
                .filter(|at| *at <= body.len())
                .ok_or(Fault::Damaged("raw data"))?;
            if mask & content::META_DATA != 0 {
                let head = Reader {
                    bytes: &body[..raw_at],
                    big_endian: lead.big_endian,
                };
                self.meta_data(head, mask & content::NEW_OBJECTS != 0)?;
            }
            if mask & content::RAW_DATA != 0 {
                if mask & content::DAQMX != 0 {
                    return Err(Fault::Refused(OF_DAQMX.into()));
                }
                let interleaved = mask & content::INTERLEAVED != 0;
                self.raw_data(&body[raw_at..], interleaved, lead.big_endian)?;
            }
            at += LEAD_IN + length;
        }
        Ok(())
    }

    fn meta_data(&mut self, mut head: Reader<'_>, is_new: bool) -> Result<(), Fault> {
        if is_new {
            self.active.clear();
        }
        let count = head.u32()?;
        if count > MOST_OBJECTS {
            return Err(Fault::Damaged("number of objects"));
        }
        for _ in 0..count {
            let path = names(&head.text()?);
            let place = match self.objects.iter().position(|object| object.path == path) {
                Some(place) => place,
                None => {
                    self.objects.push(Object {
                        path,
                        index: None,
                        properties: BTreeMap::new(),
                        values: Vec::new(),
                        has_texts: false,
                    });
                    self.objects.len() - 1
                }
            };
            let length = head.u32()?;
            let has_data = match length {
                NO_DATA => false,
                AS_BEFORE => true,
                _ if DAQMX.contains(&length) => {
                    return Err(Fault::Refused(OF_DAQMX.into()));
                }
                _ => {
                    self.objects[place].index = head.index()?;
                    self.objects[place].index.is_some()
                }
            };
            self.active.retain(|active| *active != place || has_data);
            if has_data && !self.active.contains(&place) {
                self.active.push(place);
            }
            let properties = head.u32()?;
            if properties > MOST_OBJECTS {
                return Err(Fault::Damaged("number of properties"));
            }
            for _ in 0..properties {
                let name = head.text()?;
                let value = head.property()?;
                self.objects[place].properties.insert(name, value);
            }
        }
        Ok(())
    }

    /// Reads the chunks of a segment; the last one may be cut off.
    fn raw_data(&mut self, bytes: &[u8], interleaved: bool, big_endian: bool) -> Result<(), Fault> {
        let active = self.active.iter();
        let indices: Vec<(usize, Index)> = active
            .filter_map(|place| Some((*place, self.objects[*place].index?)))
            .collect();
        let sizes = indices.iter().map(|(_, index)| index.bytes());
        let chunk = sizes
            .into_iter()
            .try_fold(0_u64, |sum, size| sum.checked_add(size?));
        let chunk = chunk.ok_or(Fault::Damaged("size of the raw data"))?;
        if chunk == 0 {
            return Ok(());
        }
        let mut rest = bytes;
        while !rest.is_empty() {
            let here = &rest[..rest.len().min(usize::try_from(chunk).unwrap_or(usize::MAX))];
            match interleaved {
                true => self.rows(here, &indices, big_endian)?,
                false => self.blocks(here, &indices, big_endian)?,
            }
            rest = &rest[here.len()..];
        }
        Ok(())
    }

    /// All values of an object, then those of the next.
    fn blocks(
        &mut self,
        mut bytes: &[u8],
        indices: &[(usize, Index)],
        big_endian: bool,
    ) -> Result<(), Fault> {
        for (place, index) in indices {
            let length = index.bytes().unwrap_or(0).min(bytes.len() as u64) as usize;
            let (own, rest) = bytes.split_at(length);
            bytes = rest;
            let Some(size) = index.kind.size() else {
                self.objects[*place].has_texts = true;
                continue;
            };
            let numbers = own
                .chunks_exact(size)
                .map(|value| index.kind.number(value, big_endian));
            self.objects[*place].values.extend(numbers);
        }
        Ok(())
    }

    /// A value of each object, then the next ones.
    fn rows(
        &mut self,
        bytes: &[u8],
        indices: &[(usize, Index)],
        big_endian: bool,
    ) -> Result<(), Fault> {
        let sizes: Option<Vec<usize>> =
            indices.iter().map(|(_, index)| index.kind.size()).collect();
        let sizes = sizes.ok_or(Fault::Damaged("interleaved texts"))?;
        let row = sizes.iter().sum::<usize>();
        for mut values in bytes.chunks_exact(row) {
            for ((place, index), size) in indices.iter().zip(&sizes) {
                let (own, rest) = values.split_at(*size);
                self.objects[*place]
                    .values
                    .push(index.kind.number(own, big_endian));
                values = rest;
            }
        }
        Ok(())
    }

    /// Series of channels of a group with the same times, and the notices.
    fn finish(self, name: &str) -> (Vec<Series>, Vec<String>) {
        let mut notices = self.notices;
        let mut made: Vec<(String, Timing, Series)> = Vec::new();
        let channels = self
            .objects
            .into_iter()
            .filter(|object| object.path.len() == 2);
        for object in channels {
            let [group, title] = [&object.path[0], &object.path[1]];
            if object.has_texts {
                notices.push(format!("channel {} has texts, left out", quoted(title)));
                continue;
            }
            if object.values.is_empty() {
                notices.push(format!("channel {} has no values, left out", quoted(title)));
                continue;
            }
            let timing = Timing::of(&object);
            let text = |key: &str| match object.properties.get(key) {
                Some(Property::Text(text)) if !text.is_empty() => Some(text.clone()),
                _ => None,
            };
            let scale = match scaling(&object.properties) {
                Ok(scale) => scale,
                Err(why) => {
                    notices.push(format!(
                        "channel {} {why}: its values are as stored",
                        quoted(title)
                    ));
                    [0.0, 1.0]
                }
            };
            let channel = Channel {
                name: title.clone(),
                unit: text("unit_string").or_else(|| text("NI_UnitDescription")),
                values: object
                    .values
                    .iter()
                    .map(|raw| scale[0] + scale[1] * raw)
                    .collect(),
            };
            let known = made
                .iter_mut()
                .find(|(of, as_known, _)| of == group && *as_known == timing);
            match known {
                Some((.., series)) => series.channels.push(channel),
                None => {
                    let rows = timing.rows;
                    let series = Series {
                        name: format!("{name} {group}"),
                        rows,
                        time_s: timing.step_s.map(|step_s| {
                            let times = (0..rows).map(|row| timing.offset_s + step_s * row as f64);
                            times.collect()
                        }),
                        channels: vec![channel],
                        texts: Vec::new(),
                    };
                    made.push((group.clone(), timing, series));
                }
            }
        }
        (
            made.into_iter().map(|(.., series)| series).collect(),
            notices,
        )
    }
}

/// Times of the values of a channel.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Timing {
    rows: usize,
    offset_s: f64,
    step_s: Option<f64>,
}

impl Timing {
    fn of(object: &Object) -> Self {
        let number = |key: &str| match object.properties.get(key) {
            Some(Property::Number(number)) => Some(*number),
            _ => None,
        };
        Self {
            rows: object.values.len(),
            offset_s: number("wf_start_offset").unwrap_or(0.0),
            step_s: number("wf_increment").filter(|step| *step > 0.0),
        }
    }
}

/// Offset and factor of the scaling that the properties state.
fn scaling(properties: &BTreeMap<String, Property>) -> Result<[f64; 2], String> {
    let number = |key: &str| match properties.get(key) {
        Some(Property::Number(number)) => Some(*number),
        _ => None,
    };
    let Some(count) = number("NI_Number_Of_Scales").filter(|count| *count > 0.0) else {
        return Ok([0.0, 1.0]);
    };
    let is_scaled = properties.get("NI_Scaling_Status") == Some(&Property::Text("scaled".into()));
    if is_scaled {
        return Ok([0.0, 1.0]);
    }
    let key = |name: &str| format!("NI_Scale[{}]_{name}", count as u64 - 1);
    match properties.get(&key("Scale_Type")) {
        Some(Property::Text(kind)) if kind == "Linear" && count == 1.0 => Ok([
            number(&key("Linear_Y_Intercept")).unwrap_or(0.0),
            number(&key("Linear_Slope")).unwrap_or(1.0),
        ]),
        Some(Property::Text(kind)) => Err(format!("has an unsupported scaling ({kind})")),
        _ => Err("has an unsupported scaling".into()),
    }
}

/// The names in a path, `/'group'/'channel'` with doubled apostrophes in names.
fn names(path: &str) -> Vec<String> {
    let mut names = Vec::new();
    let mut letters = path.chars().peekable();
    let mut name: Option<String> = None;
    while let Some(letter) = letters.next() {
        match (&mut name, letter) {
            (None, '\'') => name = Some(String::new()),
            (Some(open), '\'') if letters.peek() == Some(&'\'') => {
                letters.next();
                open.push('\'');
            }
            (Some(_), '\'') => names.extend(name.take()),
            (Some(open), letter) => open.push(letter),
            (None, _) => {}
        }
    }
    names
}

/// Bytes that are read from the front.
struct Reader<'a> {
    bytes: &'a [u8],
    big_endian: bool,
}

impl<'a> Reader<'a> {
    fn take(&mut self, count: usize) -> Result<&'a [u8], Fault> {
        let (taken, rest) = self
            .bytes
            .split_at_checked(count)
            .ok_or(Fault::Damaged("cut off"))?;
        self.bytes = rest;
        Ok(taken)
    }

    fn u32(&mut self) -> Result<u32, Fault> {
        let bytes = self
            .take(4)?
            .try_into()
            .map_err(|_| Fault::Damaged("cut off"))?;
        Ok(match self.big_endian {
            true => u32::from_be_bytes(bytes),
            false => u32::from_le_bytes(bytes),
        })
    }

    fn u64(&mut self) -> Result<u64, Fault> {
        let bytes = self
            .take(8)?
            .try_into()
            .map_err(|_| Fault::Damaged("cut off"))?;
        Ok(match self.big_endian {
            true => u64::from_be_bytes(bytes),
            false => u64::from_le_bytes(bytes),
        })
    }

    fn text(&mut self) -> Result<String, Fault> {
        let length = self.u32()? as usize;
        Ok(String::from_utf8_lossy(self.take(length)?).into_owned())
    }

    /// The index of raw data; `None` for types without a number.
    fn index(&mut self) -> Result<Option<Index>, Fault> {
        let kind = self.u32()?;
        let kind = DataType::of(kind).ok_or_else(|| {
            Fault::Refused(format!(
                "has values of the unsupported type {kind:#x}, expected numbers"
            ))
        })?;
        if self.u32()? != 1 {
            return Err(Fault::Damaged("dimension"));
        }
        let count = self.u64()?;
        let bytes = match kind {
            DataType::Text => self.u64()?,
            _ => 0,
        };
        Ok(Some(Index { kind, count, bytes }).filter(|index| index.count > 0))
    }

    fn property(&mut self) -> Result<Property, Fault> {
        let kind = DataType::of(self.u32()?).ok_or(Fault::Damaged("type of a property"))?;
        Ok(match kind.size() {
            None => Property::Text(self.text()?),
            Some(size) => {
                let bytes = self.take(size)?;
                Property::Number(kind.number(bytes, self.big_endian))
            }
        })
    }
}

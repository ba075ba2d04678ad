//! Symbols of a controller: addresses, types, and conversion of their bytes to numbers.

use crate::symbols::{Content, Expected, RequiredSymbol, ValueKind};

/// Largest symbol (bytes), so that an invalid response cannot fill the memory.
const LARGEST: usize = 1 << 20;

/// Address of a symbol's data in the controller.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct SymbolAddress {
    pub group: u32,
    pub offset: u32,
    pub size: usize,
}

impl SymbolAddress {
    /// The version of the symbols, which changes with the program, so that addresses are never used in another program.
    pub const VERSION: Self = Self {
        group: 0xF008,
        offset: 0,
        size: 1,
    };

    /// The address as three words of a request.
    pub fn head(&self) -> [[u8; 4]; 3] {
        let size = u32::try_from(self.size).unwrap_or(u32::MAX);
        [self.group, self.offset, size].map(u32::to_le_bytes)
    }
}

/// An elementary type.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Elementary {
    Bool,
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
    /// Characters; the whole text is one element.
    Text,
    /// Anything else.
    Other,
}

impl Elementary {
    /// The type according to its name (for arrays, that of the elements), or to the number of the base type if the name is an
    /// alias.
    fn of(type_name: &str, base: u32) -> Self {
        let upper = type_name.to_ascii_uppercase();
        let element = upper.rsplit(" OF ").next().unwrap_or_default().trim();
        let name = element.split('(').next().unwrap_or_default();
        if element.contains(" TO ") {
            return Self::Other; // a pointer or reference
        }
        match (name, base) {
            ("BOOL" | "BIT", _) | (_, 33) => Self::Bool,
            ("SINT", _) | (_, 16) => Self::I8,
            ("USINT" | "BYTE", _) | (_, 17) => Self::U8,
            ("INT", _) | (_, 2) => Self::I16,
            ("UINT" | "WORD", _) | (_, 18) => Self::U16,
            ("DINT", _) | (_, 3) => Self::I32,
            ("UDINT" | "DWORD", _) | (_, 19) => Self::U32,
            ("LINT", _) | (_, 20) => Self::I64,
            ("ULINT" | "LWORD", _) | (_, 21) => Self::U64,
            ("REAL", _) | (_, 4) => Self::F32,
            ("LREAL", _) | (_, 5) => Self::F64,
            ("STRING", _) | (_, 30) => Self::Text,
            _ => Self::Other,
        }
    }

    /// Size of one element (bytes); 1 for texts.
    fn size(self) -> usize {
        match self {
            Self::Bool | Self::I8 | Self::U8 | Self::Text | Self::Other => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }

    /// Kind of value, independent of the protocol.
    fn value_kind(self) -> ValueKind {
        match self {
            Self::Bool => ValueKind::Flag,
            Self::U32 => ValueKind::Counter,
            Self::I8 | Self::U8 | Self::I16 | Self::U16 | Self::I32 | Self::I64 | Self::U64 => {
                ValueKind::Integer
            }
            Self::F32 | Self::F64 => ValueKind::Real,
            Self::Text => ValueKind::Text,
            Self::Other => ValueKind::Other,
        }
    }
}

/// The types of the controller that match an expectation, in words.
fn types_of(expected: Expected) -> &'static str {
    match expected {
        Expected::Flag => "BOOL",
        Expected::Integer => "an integer",
        Expected::Code => "an integer or BOOL",
        Expected::Counter => "UDINT",
        Expected::Number => "a number (BOOL, an integer, REAL or LREAL)",
        Expected::Text => "STRING",
    }
}

/// A symbol as described by the controller.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Symbol {
    pub name: String,
    pub group: u32,
    pub offset: u32,
    /// Total size (bytes).
    pub size: usize,
    pub kind: Elementary,
    /// Name of its type in the controller.
    pub type_name: String,
}

impl Symbol {
    /// Parses the entry of a symbol: numbers of 32 bits, the lengths of three texts (16 bits each), and the texts.
    pub fn parse(name: &str, entry: &[u8]) -> Option<Self> {
        let word = |at: usize| Some(u32::from_le_bytes(entry.get(at..at + 4)?.try_into().ok()?));
        let half = |at: usize| Some(u16::from_le_bytes(entry.get(at..at + 2)?.try_into().ok()?));
        let (name_len, type_len) = (usize::from(half(24)?), usize::from(half(26)?));
        let start = 30 + name_len + 1;
        let text = entry.get(start..start + type_len)?;
        let type_name = String::from_utf8_lossy(text).into_owned();
        Some(Self {
            name: name.to_owned(),
            group: word(4)?,
            offset: word(8)?,
            size: usize::try_from(word(12)?).ok()?,
            kind: Elementary::of(&type_name, word(16)?),
            type_name,
        })
    }

    /// Number of elements.
    pub fn count(&self) -> usize {
        match self.kind {
            Elementary::Text => 1,
            kind => self.size / kind.size(),
        }
    }

    /// The problem with its type, to be appended to the name of the type.
    pub fn problem(&self, wanted: &RequiredSymbol) -> Option<String> {
        let found = (self.kind.value_kind(), self.count());
        let too_large = || {
            let size = self.size;
            (size > LARGEST).then(|| format!("which has {size} bytes, expected at most {LARGEST}"))
        };
        wanted.problem(found, types_of).or_else(too_large)
    }

    /// Address of all its data.
    pub fn place(&self) -> SymbolAddress {
        SymbolAddress {
            group: self.group,
            offset: self.offset,
            size: self.size,
        }
    }

    /// Address of an element.
    pub fn element_place(&self, element: usize) -> Option<SymbolAddress> {
        let size = self.kind.size();
        let offset = u32::try_from(element.checked_mul(size)?).ok()?;
        (element < self.count()).then_some(SymbolAddress {
            group: self.group,
            offset: self.offset.checked_add(offset)?,
            size,
        })
    }

    /// Converts its bytes.
    pub fn content(&self, bytes: &[u8]) -> Content {
        if self.kind == Elementary::Text {
            return Content::Text(text_of(bytes));
        }
        let elements = bytes.chunks_exact(self.kind.size());
        let number = |element| decode(self.kind, element).unwrap_or(f64::NAN);
        Content::Numbers(elements.map(number).collect())
    }
}

/// The characters of a text up to its terminator.
fn text_of(bytes: &[u8]) -> String {
    let end = bytes.iter().position(|b| *b == 0).unwrap_or(bytes.len());
    // Texts of a controller have one byte per character, as in Windows-1252.
    let characters = bytes[..end].iter().map(|b| char::from(*b));
    characters.filter(|c| !c.is_control()).collect()
}

fn decode(kind: Elementary, bytes: &[u8]) -> Option<f64> {
    Some(match kind {
        Elementary::Bool => f64::from(u8::from(bytes.iter().any(|b| *b != 0))),
        Elementary::I8 => f64::from(i8::from_le_bytes(bytes.try_into().ok()?)),
        Elementary::U8 => f64::from(u8::from_le_bytes(bytes.try_into().ok()?)),
        Elementary::I16 => f64::from(i16::from_le_bytes(bytes.try_into().ok()?)),
        Elementary::U16 => f64::from(u16::from_le_bytes(bytes.try_into().ok()?)),
        Elementary::I32 => f64::from(i32::from_le_bytes(bytes.try_into().ok()?)),
        Elementary::U32 => f64::from(u32::from_le_bytes(bytes.try_into().ok()?)),
        Elementary::I64 => i64::from_le_bytes(bytes.try_into().ok()?) as f64,
        Elementary::U64 => u64::from_le_bytes(bytes.try_into().ok()?) as f64,
        Elementary::F32 => f64::from(f32::from_le_bytes(bytes.try_into().ok()?)),
        Elementary::F64 => f64::from_le_bytes(bytes.try_into().ok()?),
        Elementary::Text | Elementary::Other => return None,
    })
}

/// The bytes of a number, rounded for integer types. `None` if the type cannot represent it.
pub(super) fn encode(kind: Elementary, value: f64) -> Option<Vec<u8>> {
    let whole = value.round();
    let within = |lower: f64, upper: f64| (lower..=upper).contains(&whole);
    /// Two to the power of 63: the smallest number that is too large.
    const TOP: f64 = 9_223_372_036_854_775_808.0;
    match kind {
        Elementary::Bool if value == 0.0 || value == 1.0 => Some(vec![u8::from(value == 1.0)]),
        Elementary::I8 if within(-128.0, 127.0) => Some((whole as i8).to_le_bytes().into()),
        Elementary::U8 if within(0.0, 255.0) => Some((whole as u8).to_le_bytes().into()),
        Elementary::I16 if within(i16::MIN.into(), i16::MAX.into()) => {
            Some((whole as i16).to_le_bytes().into())
        }
        Elementary::U16 if within(0.0, u16::MAX.into()) => {
            Some((whole as u16).to_le_bytes().into())
        }
        Elementary::I32 if within(i32::MIN.into(), i32::MAX.into()) => {
            Some((whole as i32).to_le_bytes().into())
        }
        Elementary::U32 if within(0.0, u32::MAX.into()) => {
            Some((whole as u32).to_le_bytes().into())
        }
        Elementary::I64 if (-TOP..TOP).contains(&whole) => {
            Some((whole as i64).to_le_bytes().into())
        }
        Elementary::U64 if (0.0..2.0 * TOP).contains(&whole) => {
            Some((whole as u64).to_le_bytes().into())
        }
        Elementary::F32 if (value as f32).is_finite() => Some((value as f32).to_le_bytes().into()),
        Elementary::F64 => Some(value.to_le_bytes().into()),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::symbols::access::Count;

    fn entry(type_name: &str, base: u32, size: u32) -> Vec<u8> {
        let mut bytes = Vec::new();
        for word in [0, 0x4040, 16, size, base, 0] {
            bytes.extend_from_slice(&u32::to_le_bytes(word));
        }
        for half in [3_u16, u16::try_from(type_name.len()).unwrap(), 0] {
            bytes.extend_from_slice(&half.to_le_bytes());
        }
        bytes.extend_from_slice(b"G.x\0");
        bytes.extend_from_slice(type_name.as_bytes());
        bytes.extend_from_slice(b"\0\0");
        bytes
    }

    #[test]
    fn entries_of_symbols_are_read() {
        let array = Symbol::parse("G.x", &entry("ARRAY [1..8, 1..3] OF LREAL", 65, 192)).unwrap();
        assert_eq!((array.kind, array.count()), (Elementary::F64, 24));
        let last = array.element_place(23).unwrap();
        assert_eq!((last.offset, last.size), (16 + 184, 8));
        assert_eq!(array.element_place(24), None);
        let wanted = |expected, count| RequiredSymbol {
            name: "G.x".into(),
            expected,
            count,
        };
        let good = wanted(Expected::Number, Count::Exactly(24));
        assert_eq!(array.problem(&good), None);
        let short = array.problem(&wanted(Expected::Number, Count::AtLeast(25)));
        assert_eq!(
            short.as_deref(),
            Some("which has 24 values, expected at least 25")
        );
        let one = |expected| wanted(expected, Count::Exactly(1));
        let list = Symbol::parse("G.x", &entry("E_State", 2, 2)).unwrap();
        assert_eq!(list.problem(&one(Expected::Code)), None);
        let text = Symbol::parse("G.x", &entry("STRING(80)", 30, 81)).unwrap();
        assert_eq!((text.kind, text.count()), (Elementary::Text, 1));
        let problem = text.problem(&one(Expected::Flag));
        assert_eq!(problem.as_deref(), Some("expected BOOL"));
        let other = Symbol::parse("G.x", &entry("ST_Winch", 65, 40)).unwrap();
        assert!(other.problem(&one(Expected::Number)).is_some());
        let whole = entry("LREAL", 5, 8);
        for length in 0..30 {
            assert_eq!(Symbol::parse("G.x", &whole[..length]), None);
        }
    }

    #[test]
    fn numbers_come_back_from_their_bytes() {
        use Elementary as E;
        for (kind, values) in [
            (E::Bool, vec![0.0, 1.0]),
            (E::I8, vec![-128.0, 127.0]),
            (E::U8, vec![0.0, 255.0]),
            (E::I16, vec![-32768.0, 32767.0]),
            (E::U16, vec![65535.0]),
            (E::I32, vec![f64::from(i32::MIN), f64::from(i32::MAX)]),
            (E::U32, vec![f64::from(u32::MAX)]),
            (E::I64, vec![-9_007_199_254_740_992.0]),
            (E::U64, vec![9_007_199_254_740_992.0]),
            (E::F32, vec![0.5, -3.0]),
            (E::F64, vec![0.1, f64::MAX]),
        ] {
            for value in values {
                let bytes = encode(kind, value).unwrap();
                assert_eq!(bytes.len(), kind.size());
                assert_eq!(decode(kind, &bytes), Some(value), "{kind:?}");
            }
        }
        for (kind, value) in [
            (E::Bool, 2.0),
            (E::I8, 128.0),
            (E::U32, -1.0),
            (E::I64, 1e19),
            (E::U64, f64::NAN),
            (E::F32, 1e40),
            (E::Text, 0.0),
        ] {
            assert_eq!(encode(kind, value), None, "{kind:?}");
        }
    }
}

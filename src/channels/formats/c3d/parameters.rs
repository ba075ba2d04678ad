//! Parameters of a C3D file: arrays by group and name, as a chain of entries between header and data.

use super::processor::Processor;
use crate::text::decoded;

/// Maximum number of continuation parameters of one with more than 255 elements: `LABELS`, `LABELS2`, `LABELS3`, ...
const CONTINUED: usize = 300;

pub struct Parameters {
    processor: Processor,
    groups: Vec<(u8, String)>,
    all: Vec<Parameter>,
    /// Whether the chain of entries ends with its terminator.
    pub is_whole: bool,
}

struct Parameter {
    group: u8,
    name: String,
    kind: ParameterType,
    /// Elements of the first dimension, which are the letters of a text.
    width: usize,
    data: Vec<u8>,
}

#[derive(Clone, Copy, PartialEq)]
enum ParameterType {
    Text,
    Byte,
    Integer,
    Float,
}

impl ParameterType {
    fn of(code: u8) -> Option<Self> {
        match code {
            0xff => Some(Self::Text),
            1 => Some(Self::Byte),
            2 => Some(Self::Integer),
            4 => Some(Self::Float),
            _ => None,
        }
    }

    fn bytes(self) -> usize {
        match self {
            Self::Text | Self::Byte => 1,
            Self::Integer => 2,
            Self::Float => 4,
        }
    }
}

impl Parameters {
    /// Reads the entries, as many as are well formed.
    pub fn parse(processor: Processor, bytes: &[u8]) -> Self {
        let mut parameters = Self {
            processor,
            groups: Vec::new(),
            all: Vec::new(),
            is_whole: false,
        };
        let mut rest = Some(bytes);
        while let Some(bytes) = rest {
            if bytes.first().is_none_or(|length| *length == 0) {
                parameters.is_whole = true;
                break;
            }
            rest = parameters.entry(bytes);
        }
        parameters
    }

    /// Parses a group or a parameter and returns the remaining bytes.
    fn entry<'a>(&mut self, bytes: &'a [u8]) -> Option<&'a [u8]> {
        let ([length, number], bytes) = bytes.split_first_chunk()?;
        // Negative lengths are those of entries that are locked, negative numbers those of groups.
        let length = length.cast_signed().unsigned_abs();
        let (name, bytes) = bytes.split_at_checked(length.into())?;
        let name = text(name).to_uppercase();
        let (offset, content) = bytes.split_first_chunk()?;
        let offset = usize::from(self.processor.integer(*offset));
        let number = number.cast_signed();
        if number < 0 {
            self.groups.push((number.unsigned_abs(), name));
        } else {
            let parameter = parameter(number.unsigned_abs(), name, content)?;
            self.all.push(parameter);
        }
        match offset {
            0 => Some(&[]),
            1 => None,
            offset => bytes.get(offset..),
        }
    }

    fn find(&self, group: &str, name: &str) -> Option<&Parameter> {
        let mut groups = self.groups.iter();
        let (number, _) = groups.find(|(_, known)| known == group)?;
        let mut all = self.all.iter();
        all.find(|one| one.group == *number && one.name == name)
    }

    /// A parameter and those that continue it.
    fn continued(&self, group: &str, name: &str) -> impl Iterator<Item = &Parameter> {
        let numbered = (2..CONTINUED).map(move |k| format!("{name}{k}"));
        let names = std::iter::once(name.to_owned()).chain(numbered);
        names.map_while(move |name| self.find(group, &name))
    }

    /// The texts of a parameter without the blanks at their ends; none where there is no such parameter.
    pub fn texts(&self, group: &str, name: &str) -> Vec<String> {
        let all = self.continued(group, name);
        let all = all.filter(|one| one.kind == ParameterType::Text && one.width > 0);
        all.flat_map(|one| one.data.chunks(one.width).map(text))
            .collect()
    }

    /// The numbers of a parameter; none where there is no such parameter.
    pub fn numbers(&self, group: &str, name: &str) -> Vec<f64> {
        self.numbers_by(group, name, |word| f64::from(word.cast_signed()))
    }

    /// The numbers of a parameter that cannot be negative.
    pub fn counts(&self, group: &str, name: &str) -> Vec<f64> {
        self.numbers_by(group, name, f64::from)
    }

    fn numbers_by(&self, group: &str, name: &str, integer: fn(u16) -> f64) -> Vec<f64> {
        let of = |one: &Parameter| -> Vec<f64> {
            match one.kind {
                ParameterType::Text => Vec::new(),
                ParameterType::Byte => one.data.iter().map(|byte| f64::from(*byte)).collect(),
                ParameterType::Integer => {
                    let (words, _) = one.data.as_chunks();
                    let words = words.iter().map(|word| self.processor.integer(*word));
                    words.map(integer).collect()
                }
                ParameterType::Float => {
                    let (words, _) = one.data.as_chunks();
                    let words = words.iter().map(|word| self.processor.float(*word));
                    words.collect()
                }
            }
        };
        self.continued(group, name).flat_map(of).collect()
    }
}

/// Type, dimensions and data of a parameter.
fn parameter(group: u8, name: String, content: &[u8]) -> Option<Parameter> {
    let ([kind, dimensions], content) = content.split_first_chunk()?;
    let kind = ParameterType::of(*kind)?;
    let (dimensions, content) = content.split_at_checked(usize::from(*dimensions))?;
    let count = dimensions.iter().try_fold(kind.bytes(), |bytes, size| {
        bytes.checked_mul(usize::from(*size))
    })?;
    Some(Parameter {
        group,
        name,
        kind,
        width: dimensions.first().map_or(1, |width| usize::from(*width)),
        data: content.get(..count)?.to_vec(),
    })
}

/// A text without the blanks and zeros at its ends.
fn text(bytes: &[u8]) -> String {
    let text = decoded(bytes);
    let text = text.trim_matches(|letter: char| letter.is_whitespace() || letter == '\0');
    text.replace(char::is_control, "?")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An entry that the next one follows.
    fn entry(name: &str, number: i8, content: &[u8]) -> Vec<u8> {
        let offset = (content.len() as u16 + 2).to_le_bytes();
        let head = [name.len() as u8, number.cast_unsigned()];
        [&head, name.as_bytes(), &offset, content].concat()
    }

    #[test]
    fn parameters_are_found_by_group_and_name() {
        let bytes = [
            // A group may come behind its parameters.
            entry("Labels", 1, b"\xff\x02\x03\x02A  BB \0"),
            entry("LABELS2", 1, b"\xff\x02\x01\x01C\0"),
            entry("USED", 1, &[2, 0, 0xff, 0xff, 0]),
            entry("RATE", 2, &[4, 0, 0, 0, 0x20, 0x41, 0]),
            entry("POINT", -1, b"\0"),
            entry("ANALOG", -2, b"\0"),
            vec![0; 20],
        ]
        .concat();
        let parameters = Parameters::parse(Processor::Intel, &bytes);
        assert!(parameters.is_whole);
        assert_eq!(parameters.texts("POINT", "LABELS"), ["A", "BB", "C"]);
        assert_eq!(parameters.numbers("POINT", "USED"), [-1.0]);
        assert_eq!(parameters.counts("POINT", "USED"), [65535.0]);
        assert_eq!(parameters.numbers("ANALOG", "RATE"), [10.0]);
        assert_eq!(parameters.numbers("POINT", "RATE"), [0.0; 0]);
        assert_eq!(parameters.numbers("POINT", "LABELS"), [0.0; 0]);
    }

    #[test]
    fn what_is_damaged_ends_the_chain() {
        for content in [
            &[9, 0, 0][..],
            &[2, 7, 255, 255, 255, 255, 255, 255, 255],
            &[4, 3, 255, 255, 255, 0],
            &[2],
        ] {
            let bytes = [entry("POINT", -1, b"\0"), entry("USED", 1, content)].concat();
            let parameters = Parameters::parse(Processor::Intel, &bytes);
            assert!(!parameters.is_whole && parameters.all.is_empty());
        }
    }
}

//! Encodings of text.

use std::io::{Read, Result as IoResult};

/// Encoding of a text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Encoding {
    /// UTF-8, or Windows-1252 (Latin-1 with the characters that Windows adds) in lines that are not UTF-8.
    Bytes {
        /// Whether any line is Windows-1252.
        latin: bool,
    },
    /// UTF-16, as Excel writes "Unicode text".
    Utf16 {
        /// Whether the high byte comes first.
        big_endian: bool,
    },
}

const UTF_8_MARK: &[u8] = b"\xef\xbb\xbf";

impl Encoding {
    /// The encoding of a file that begins with `head`: by its byte order mark, or by the zero bytes of UTF-16 without one.
    pub fn of(head: &[u8]) -> Self {
        let zeros = |first: usize| {
            let bytes = head.iter().skip(first).step_by(2).take(64);
            let count = bytes.clone().count();
            count >= 4 && bytes.filter(|byte| **byte == 0).count() * 10 >= count * 9
        };
        match head {
            [0xff, 0xfe, ..] => Self::Utf16 { big_endian: false },
            [0xfe, 0xff, ..] => Self::Utf16 { big_endian: true },
            _ if zeros(1) && !zeros(0) => Self::Utf16 { big_endian: false },
            _ if zeros(0) && !zeros(1) => Self::Utf16 { big_endian: true },
            _ => Self::Bytes { latin: false },
        }
    }

    /// The bytes after a byte order mark.
    pub fn skip_mark<R: Read>(self, mut reader: R) -> impl Read {
        let mut first = Vec::new();
        // An error here occurs again below, where it is reported.
        let _ = (&mut reader).take(3).read_to_end(&mut first);
        let skipped = match self {
            Self::Utf16 { .. } if matches!(first[..], [0xff, 0xfe, ..] | [0xfe, 0xff, ..]) => 2,
            Self::Bytes { .. } if first == UTF_8_MARK => 3,
            _ => 0,
        };
        std::io::Cursor::new(first.split_off(skipped)).chain(reader)
    }

    /// Its name if it is unusual.
    pub fn name(self) -> Option<&'static str> {
        match self {
            Self::Bytes { latin: false } => None,
            Self::Bytes { latin: true } => Some("Windows-1252"),
            Self::Utf16 { big_endian: false } => Some("UTF-16, little endian"),
            Self::Utf16 { big_endian: true } => Some("UTF-16, big endian"),
        }
    }
}

/// The beginning of a text, decoded; a character that is cut at its end is left out.
pub(crate) fn decoded(head: &[u8]) -> String {
    let encoding = Encoding::of(head);
    let mut bytes = Vec::new();
    // A slice can always be read.
    let _ = encoding.skip_mark(head).read_to_end(&mut bytes);
    match encoding {
        Encoding::Utf16 { big_endian } => {
            let pairs = bytes.chunks_exact(2);
            let units = pairs.map(|pair| unit([pair[0], pair[1]], big_endian));
            char::decode_utf16(units).filter_map(Result::ok).collect()
        }
        Encoding::Bytes { .. } => match std::str::from_utf8(&bytes) {
            Ok(text) => text.into(),
            Err(error) if error.error_len().is_none() => {
                String::from_utf8_lossy(&bytes[..error.valid_up_to()]).into_owned()
            }
            Err(_) => bytes.iter().map(|byte| windows_1252(*byte)).collect(),
        },
    }
}

fn unit(bytes: [u8; 2], big_endian: bool) -> u16 {
    if big_endian {
        u16::from_be_bytes(bytes)
    } else {
        u16::from_le_bytes(bytes)
    }
}

/// A character of Windows-1252: Latin-1, but for the 32 characters from 0x80 on.
pub(super) fn windows_1252(byte: u8) -> char {
    const FROM_0X80: [char; 32] = [
        '€', '\u{81}', '‚', 'ƒ', '„', '…', '†', '‡', 'ˆ', '‰', 'Š', '‹', 'Œ', '\u{8d}', 'Ž',
        '\u{8f}', '\u{90}', '‘', '’', '“', '”', '•', '–', '—', '˜', '™', 'š', '›', 'œ', '\u{9d}',
        'ž', 'Ÿ',
    ];
    match byte {
        0x80..=0x9f => FROM_0X80[usize::from(byte - 0x80)],
        _ => char::from(byte),
    }
}

/// UTF-16 as UTF-8. Half a surrogate pair becomes the replacement character.
pub(super) struct Utf16Reader<R> {
    inner: R,
    big_endian: bool,
    /// The first half of a pair whose second half is still to come.
    high: Option<u16>,
    /// Decoded UTF-8, pending from `given` on.
    ready: Vec<u8>,
    given: usize,
}

impl<R: Read> Utf16Reader<R> {
    pub fn new(inner: R, big_endian: bool) -> Self {
        Self {
            inner,
            big_endian,
            high: None,
            ready: Vec::new(),
            given: 0,
        }
    }

    fn fill(&mut self) -> IoResult<()> {
        let mut bytes = Vec::with_capacity(8192);
        (&mut self.inner).take(8192).read_to_end(&mut bytes)?;
        self.ready.clear();
        self.given = 0;
        let pairs = bytes.chunks_exact(2);
        let units = pairs.map(|pair| unit([pair[0], pair[1]], self.big_endian));
        let mut units: Vec<u16> = self.high.take().into_iter().chain(units).collect();
        let at_end = bytes.len() < 8192;
        if let Some(last) = units.last().copied()
            && (0xd800..0xdc00).contains(&last)
            && !at_end
        {
            self.high = units.pop();
        }
        let text: String = char::decode_utf16(units)
            .map(|letter| letter.unwrap_or(char::REPLACEMENT_CHARACTER))
            .collect();
        self.ready.extend_from_slice(text.as_bytes());
        Ok(())
    }
}

impl<R: Read> Read for Utf16Reader<R> {
    fn read(&mut self, out: &mut [u8]) -> IoResult<usize> {
        if self.given == self.ready.len() {
            self.fill()?;
        }
        let count = out.len().min(self.ready.len() - self.given);
        out[..count].copy_from_slice(&self.ready[self.given..self.given + count]);
        self.given += count;
        Ok(count)
    }
}

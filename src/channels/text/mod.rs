//! Text files as lines and cells, in the encodings that recorders write.

mod cells;
mod decoding;
mod number;
mod timestamp;

use std::collections::VecDeque;
use std::io::{BufRead, BufReader, Read};

use tautline_files::{Location, ReadError};

use crate::input::Input;
use crate::memory::{MemoryBudget, OverBudget};
pub(crate) use cells::{Cells, Separator};
pub(crate) use decoding::{Encoding, decoded};
pub(crate) use number::{Decimal, is_gap, parse_number};
pub(crate) use timestamp::parse_timestamp;

/// Longest line that is read (bytes): thousands of channels, but not a file without line ends.
const MAX_LINE: u64 = 4 << 20;

/// The decoded lines of a text file, without line ends, with look-ahead.
pub(crate) struct Lines<'a> {
    reader: Box<dyn BufRead + 'a>,
    file: &'a str,
    budget: MemoryBudget,
    encoding: Encoding,
    ahead: VecDeque<(u64, String)>,
    raw: Vec<u8>,
    line: String,
    number: u64,
}

impl<'a> Lines<'a> {
    /// Reads lines of `input`, whose beginning is `head`; `file` is the name for messages.
    pub fn new(head: &[u8], input: Input<'a>, file: &'a str) -> Self {
        let budget = input.budget().clone();
        Self::within(budget, head, input, file)
    }

    fn within(budget: MemoryBudget, head: &[u8], reader: impl Read + 'a, file: &'a str) -> Self {
        let encoding = Encoding::of(head);
        let bytes = encoding.skip_mark(reader);
        let reader: Box<dyn BufRead> = match encoding {
            Encoding::Utf16 { big_endian } => Box::new(BufReader::with_capacity(
                1 << 16,
                decoding::Utf16Reader::new(bytes, big_endian),
            )),
            Encoding::Bytes { .. } => Box::new(BufReader::with_capacity(1 << 16, bytes)),
        };
        Self {
            reader,
            file,
            budget,
            encoding,
            ahead: VecDeque::new(),
            raw: Vec::new(),
            line: String::new(),
            number: 0,
        }
    }

    /// Name of the file, for messages.
    pub fn file(&self) -> &'a str {
        self.file
    }

    /// Counts the values of a row in the memory for the file: a short line may stand for as many as a long one.
    pub fn take_values(&self, count: usize) -> Result<(), ReadError> {
        let failed = |over: OverBudget| {
            ReadError::new(self.file, Location::Line(self.number), over.to_string())
        };
        self.budget.take_values(count).map_err(failed)
    }

    /// Encoding of the text.
    pub fn encoding(&self) -> Encoding {
        self.encoding
    }

    /// The next line with its number from 1.
    pub fn next_line(&mut self) -> Result<Option<(u64, &str)>, ReadError> {
        if let Some((number, line)) = self.ahead.pop_front() {
            self.line = line;
            return Ok(Some((number, &self.line)));
        }
        Ok(self.read()?.then_some((self.number, &self.line)))
    }

    /// The next `count` lines, fewer at the end of the file; they are read again by [`Self::next_line`].
    pub fn look_ahead(&mut self, count: usize) -> Result<&VecDeque<(u64, String)>, ReadError> {
        while self.ahead.len() < count && self.read()? {
            let line = std::mem::take(&mut self.line);
            self.ahead.push_back((self.number, line));
        }
        Ok(&self.ahead)
    }

    fn read(&mut self) -> Result<bool, ReadError> {
        self.raw.clear();
        let place = |number| Location::Line(number);
        let mut limited = (&mut self.reader).take(MAX_LINE);
        let read = limited.read_until(b'\n', &mut self.raw);
        let read =
            read.map_err(|error| ReadError::io(self.file, place(self.number + 1), &error))?;
        if read == 0 {
            return Ok(false);
        }
        self.number += 1;
        if read as u64 == MAX_LINE && self.raw.last() != Some(&b'\n') {
            let message = format!(
                "found more than {} MB without a line end, expected lines",
                MAX_LINE >> 20
            );
            return Err(ReadError::new(self.file, place(self.number), message));
        }
        while matches!(self.raw.last(), Some(b'\n' | b'\r')) {
            self.raw.pop();
        }
        self.line.clear();
        match std::str::from_utf8(&self.raw) {
            Ok(text) => self.line.push_str(text),
            Err(_) => {
                self.encoding = Encoding::Bytes { latin: true };
                self.line
                    .extend(self.raw.iter().map(|byte| decoding::windows_1252(*byte)));
            }
        }
        Ok(true)
    }
}

#[cfg(test)]
mod tests;

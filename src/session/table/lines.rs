//! Lines of a text file with their numbers, in bounded memory.

use std::io::{BufRead, Read};

use tautline_files::{Location, ReadError};

/// Longest record (bytes), line breaks in quoted cells included.
const MAX_RECORD: usize = 1 << 20;

const BOM: &[u8] = b"\xef\xbb\xbf";

/// Reads records: lines that are neither blank nor comments, joined while a quotation is open.
pub(super) struct Lines<R> {
    reader: R,
    file: String,
    line: u64,
    record: Vec<u8>,
}

impl<R: BufRead> Lines<R> {
    pub fn new(reader: R, file: &str) -> Self {
        Self {
            reader,
            file: file.into(),
            line: 0,
            record: Vec::new(),
        }
    }

    /// The next record without its line end, and the number of the line at which it starts.
    pub fn next_record(&mut self) -> Result<Option<(u64, &[u8])>, ReadError> {
        loop {
            self.record.clear();
            if !self.read_line()? {
                return Ok(None);
            }
            let blank = self.record.iter().all(is_blank);
            if !blank && !self.record.starts_with(b"#") {
                break;
            }
        }
        let start = self.line;
        // In RFC 4180 every quotation mark opens, closes or is doubled, so an odd number leaves a quotation open.
        let mut quotes = count_quotes(&self.record);
        while quotes % 2 == 1 {
            let length = self.record.len();
            if !self.read_line()? {
                let message = "found a quotation mark that is never closed, expected a second one";
                return Err(ReadError::new(&self.file, Location::Line(start), message));
            }
            quotes += count_quotes(&self.record[length..]);
        }
        while let Some(b'\n' | b'\r') = self.record.last() {
            self.record.pop();
        }
        Ok(Some((start, &self.record)))
    }

    /// Appends one line to the record; `false` at the end of the file.
    fn read_line(&mut self) -> Result<bool, ReadError> {
        let start = self.record.len();
        self.line += 1;
        let longest = (MAX_RECORD - start) as u64;
        let mut limited = (&mut self.reader).take(longest + 1);
        let read = limited.read_until(b'\n', &mut self.record);
        read.map_err(|error| ReadError::io(&self.file, Location::Line(self.line), &error))?;
        if self.record.len() > MAX_RECORD {
            let message = "found a line of more than 1 MB, expected a CSV table";
            let place = Location::Line(self.line);
            return Err(ReadError::new(&self.file, place, message));
        }
        if self.line == 1 {
            self.skip_byte_order_mark()?;
        }
        Ok(self.record.len() > start)
    }

    fn skip_byte_order_mark(&mut self) -> Result<(), ReadError> {
        if self.record.starts_with(BOM) {
            self.record.drain(..BOM.len());
        }
        if self.record.starts_with(b"\xff\xfe") || self.record.starts_with(b"\xfe\xff") {
            let message = "found UTF-16 text, expected UTF-8 text (in Excel: save as CSV UTF-8)";
            return Err(ReadError::new(&self.file, Location::Line(1), message));
        }
        Ok(())
    }
}

/// Spreadsheets write blank rows also as rows of separators.
fn is_blank(byte: &u8) -> bool {
    byte.is_ascii_whitespace() || matches!(byte, b',' | b';')
}

fn count_quotes(bytes: &[u8]) -> usize {
    // Nearly no line has one, and searching for the first is faster than counting.
    match bytes.contains(&b'"') {
        true => bytes.iter().filter(|byte| **byte == b'"').count(),
        false => 0,
    }
}

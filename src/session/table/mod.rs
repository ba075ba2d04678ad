//! CSV tables: columns by name, cells with their location in the file.

mod formula;
mod lines;
mod number;
mod quaternion;
mod write;

use std::collections::HashMap;
use std::io::BufRead;

pub use formula::escape_formula;
use formula::unescape_formula;
use lines::Lines;
pub(crate) use quaternion::quaternion_fault;
use tautline_files::{Location, ReadError, quoted};
pub(crate) use write::TableWriter;
pub use write::csv_row;

/// A table that is read row by row.
pub(crate) struct Table<R> {
    lines: Lines<R>,
    header: Header,
    cells: Cells,
    rows: u64,
}

/// Names of the columns, and the notation of numbers.
struct Header {
    file: String,
    line: u64,
    names: Vec<String>,
    by_name: HashMap<String, usize>,
    decimal_comma: bool,
}

/// The fields of one record: their concatenated text, and the end of each.
struct Cells {
    parser: csv_core::Reader,
    text: Vec<u8>,
    ends: Vec<usize>,
}

/// One row of a table.
pub(crate) struct TableRow<'a> {
    header: &'a Header,
    line: u64,
    text: &'a str,
    ends: &'a [usize],
}

impl<R: BufRead> Table<R> {
    /// Reads the header row.
    pub fn open(reader: R, file: &str) -> Result<Self, ReadError> {
        let mut lines = Lines::new(reader, file);
        let Some((line, record)) = lines.next_record()? else {
            let message = "found no line, expected a header row";
            return Err(ReadError::new(file, Location::File, message));
        };
        // German Excel uses semicolons as separators, because the comma is the decimal separator, and tabs on the clipboard.
        let count = |c: &u8| record.iter().filter(|byte| *byte == c).count();
        let separators = [b'\t', b';', b','];
        let separator = *separators.iter().max_by_key(|c| count(c)).unwrap_or(&b',');
        let decimal_comma = separator != b',';
        let mut cells = Cells::new(separator);
        cells.split(record, file, line)?;
        let text = utf8(&cells.text, file, line)?;
        let names = (0..cells.ends.len()).map(|k| cell(text, &cells.ends, k).to_string());
        let header = Header::new(file, line, names.collect(), decimal_comma)?;
        Ok(Self {
            lines,
            header,
            cells,
            rows: 0,
        })
    }

    /// The next row, which must have as many cells as the header.
    pub fn next_row(&mut self) -> Result<Option<TableRow<'_>>, ReadError> {
        let Self {
            lines,
            header,
            cells,
            ..
        } = self;
        let Some((line, record)) = lines.next_record()? else {
            if self.rows > 0 {
                return Ok(None);
            }
            let message = "found a header row only, expected rows of data after it";
            return Err(ReadError::new(
                &header.file,
                Location::Line(header.line),
                message,
            ));
        };
        self.rows += 1;
        cells.split(record, &header.file, line)?;
        let text = utf8(&cells.text, &header.file, line)?;
        header.check_count(line, cells.ends.len())?;
        Ok(Some(TableRow {
            header,
            line,
            text,
            ends: &cells.ends,
        }))
    }

    /// Names of the columns in the order of the file.
    pub fn names(&self) -> &[String] {
        &self.header.names
    }

    /// Index of the column called `name`.
    pub fn find(&self, name: &str) -> Option<usize> {
        self.header.by_name.get(&name.to_lowercase()).copied()
    }

    /// Index of a required column.
    pub fn require(&self, name: &str) -> Result<usize, ReadError> {
        self.find(name)
            .ok_or_else(|| self.header_error(name, "missing, expected in the header row"))
    }

    /// Indices of required columns.
    pub fn require_all<const N: usize>(&self, names: [&str; N]) -> Result<[usize; N], ReadError> {
        let mut columns = [0; N];
        for (column, name) in columns.iter_mut().zip(names) {
            *column = self.require(name)?;
        }
        Ok(columns)
    }

    /// An error about the column called `name`.
    pub fn header_error(&self, name: &str, message: impl Into<String>) -> ReadError {
        self.header.error(name, message)
    }

    /// A notice for each column that is not in `known`.
    pub fn unknown_columns(&self, known: &[&str]) -> Vec<String> {
        self.names()
            .iter()
            .filter(|name| !known.contains(&name.to_lowercase().as_str()))
            .map(|name| self.unknown_column(name, "ignored"))
            .collect()
    }

    /// A notice for an unknown column.
    pub fn unknown_column(&self, name: &str, what_happens: &str) -> String {
        let file = &self.header.file;
        format!("{file}, column {}: unknown, {what_happens}", quoted(name))
    }
}

impl Header {
    fn new(
        file: &str,
        line: u64,
        names: Vec<String>,
        decimal_comma: bool,
    ) -> Result<Self, ReadError> {
        let mut by_name = HashMap::with_capacity(names.len());
        for (k, name) in names.iter().enumerate() {
            let place = || Location::Cell(line, name.clone());
            if name.is_empty() {
                let message = format!("found no name for column {}, expected one", k + 1);
                return Err(ReadError::new(file, Location::Line(line), message));
            }
            // Spreadsheets and people write the same name in several ways.
            if by_name.insert(name.to_lowercase(), k).is_some() {
                let message = "found in the header row again, expected once";
                return Err(ReadError::new(file, place(), message));
            }
        }
        Ok(Self {
            file: file.into(),
            line,
            names,
            by_name,
            decimal_comma,
        })
    }

    fn error(&self, name: &str, message: impl Into<String>) -> ReadError {
        let place = Location::Cell(self.line, name.into());
        ReadError::new(&self.file, place, message)
    }

    fn check_count(&self, line: u64, found: usize) -> Result<(), ReadError> {
        let expected = self.names.len();
        if found == expected {
            return Ok(());
        }
        let hint = if found > expected && !self.decimal_comma {
            " (decimal commas need ; as the separator)"
        } else {
            ""
        };
        let message = format!("found {found} cells, expected {expected} as in the header{hint}");
        Err(ReadError::new(&self.file, Location::Line(line), message))
    }
}

impl Cells {
    fn new(separator: u8) -> Self {
        Self {
            parser: csv_core::ReaderBuilder::new()
                .delimiter(separator)
                .terminator(csv_core::Terminator::Any(b'\n'))
                .build(),
            text: Vec::new(),
            ends: Vec::new(),
        }
    }

    /// Splits one record into its cells.
    fn split(&mut self, record: &[u8], file: &str, line: u64) -> Result<(), ReadError> {
        // Unquoting only shortens the text, and there is at most one cell more than there are bytes.
        self.text.resize(record.len() + 1, 0);
        self.ends.resize(record.len() + 2, 0);
        self.parser.reset();
        let (_, read, written, cells) =
            self.parser
                .read_record(record, &mut self.text, &mut self.ends);
        // The end of the input terminates the record, which may add the last cell.
        let (_, _, more, last) =
            self.parser
                .read_record(&[], &mut self.text[written..], &mut self.ends[cells..]);
        if read < record.len() {
            let message = "found a quotation mark inside a cell, expected cells quoted as a whole";
            return Err(ReadError::new(file, Location::Line(line), message));
        }
        self.text.truncate(written + more);
        self.ends.truncate(cells + last);
        Ok(())
    }
}

fn utf8<'a>(text: &'a [u8], file: &str, line: u64) -> Result<&'a str, ReadError> {
    std::str::from_utf8(text).map_err(|error| {
        let byte = text[error.valid_up_to()];
        let message = format!("found the byte {byte:#04x}, expected UTF-8 text");
        ReadError::new(file, Location::Line(line), message)
    })
}

fn cell<'a>(text: &'a str, ends: &[usize], k: usize) -> &'a str {
    let start = if k == 0 { 0 } else { ends[k - 1] };
    // A cell boundary inside a character is possible only if the cells are not valid UTF-8 individually.
    let cell = text.get(start..ends[k]).unwrap_or_default();
    let is_plain = |byte: Option<&u8>| byte.is_some_and(|byte| byte.is_ascii_alphanumeric());
    // Most cells are numbers without anything to trim.
    match is_plain(cell.as_bytes().first()) && is_plain(cell.as_bytes().last()) {
        true => cell,
        false => unescape_formula(cell.trim()),
    }
}

impl TableRow<'_> {
    /// Line of the file at which the row starts.
    pub fn line(&self) -> u64 {
        self.line
    }

    /// Text of a cell.
    pub fn text(&self, column: usize) -> &str {
        cell(self.text, self.ends, column)
    }

    /// An error about a cell.
    pub fn error(&self, column: usize, message: impl Into<String>) -> ReadError {
        let place = Location::Cell(self.line, self.header.names[column].clone());
        ReadError::new(&self.header.file, place, message)
    }

    /// "found .., expected .." about a cell.
    pub fn unexpected(&self, column: usize, expected: &str) -> ReadError {
        let found = match self.text(column) {
            "" => "an empty cell".into(),
            text => quoted(text),
        };
        self.error(column, format!("found {found}, expected {expected}"))
    }

    /// A number, NaN if the cell is empty.
    pub fn number(&self, column: usize) -> Result<f64, ReadError> {
        let text = self.text(column);
        if text.is_empty() {
            return Ok(f64::NAN);
        }
        number::parse(text, self.header.decimal_comma)
            .map_err(|expected| self.unexpected(column, expected))
    }

    /// A number of an optional column; `None` if the cell is empty.
    pub fn optional(&self, column: Option<usize>) -> Result<Option<f64>, ReadError> {
        let value = column.map(|column| self.number(column)).transpose()?;
        Ok(value.filter(|value| !value.is_nan()))
    }

    /// A required number.
    pub fn required(&self, column: usize) -> Result<f64, ReadError> {
        let value = self.number(column)?;
        if value.is_nan() {
            return Err(self.unexpected(column, "a number"));
        }
        Ok(value)
    }

    /// A required number that satisfies a condition.
    pub fn required_if(
        &self,
        column: usize,
        condition: impl Fn(f64) -> bool,
        expected: &str,
    ) -> Result<f64, ReadError> {
        let value = self.required(column)?;
        if condition(value) {
            Ok(value)
        } else {
            Err(self.unexpected(column, expected))
        }
    }

    /// A quaternion of norm one, or `None` if all its cells are empty.
    pub fn quaternion(&self, columns: [usize; 4]) -> Result<Option<[f64; 4]>, ReadError> {
        let mut wxyz = [0.0; 4];
        for (value, column) in wxyz.iter_mut().zip(columns) {
            *value = self.number(column)?;
        }
        match quaternion_fault(&wxyz) {
            Some((k, message)) => Err(self.error(columns[k], message)),
            None => Ok(Some(wxyz).filter(|wxyz| !wxyz[0].is_nan())),
        }
    }

    /// A required integer.
    pub fn integer(&self, column: usize) -> Result<i64, ReadError> {
        self.text(column)
            .parse()
            .map_err(|_| self.unexpected(column, "a whole number"))
    }
}

#[cfg(test)]
mod tests;

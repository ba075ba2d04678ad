//! Writing CSV tables.

use std::fmt::Write as _;
use std::io::{Error, ErrorKind, Result, Write};

use tautline_core::robot::Robot;

use super::escape_formula;

/// Writes a table cell by cell; NaN becomes an empty cell.
pub(crate) struct TableWriter<W: Write> {
    csv: csv::Writer<W>,
    cell: String,
}

impl<W: Write> TableWriter<W> {
    /// Starts a table with its header row.
    pub fn new<S: AsRef<str>>(out: W, names: &[S]) -> Result<Self> {
        let mut writer = Self {
            csv: csv::WriterBuilder::new()
                .comment(Some(b'#'))
                .from_writer(out),
            cell: String::new(),
        };
        for name in names {
            writer.text(name.as_ref())?;
        }
        writer.end_row()?;
        Ok(writer)
    }

    /// Writes a number with the fewest digits that read back to the same number.
    pub fn number(&mut self, value: f64) -> Result<()> {
        if value.is_infinite() {
            return Err(invalid("a number is infinite".into()));
        }
        self.cell.clear();
        if !value.is_nan() {
            let _ = write!(self.cell, "{value}");
        }
        Ok(self.csv.write_field(&self.cell)?)
    }

    /// Writes an integer.
    pub fn integer(&mut self, value: i64) -> Result<()> {
        self.cell.clear();
        let _ = write!(self.cell, "{value}");
        Ok(self.csv.write_field(&self.cell)?)
    }

    /// Writes the name of a cable, which unlike its number cannot be mistaken for another cable's name.
    pub fn cable(&mut self, index: usize, robot: &Robot) -> Result<()> {
        match robot.cables.get(index) {
            Some(cable) => self.text(&cable.name),
            None => Err(invalid(format!("the robot has no cable {}", index + 1))),
        }
    }

    /// Writes a text, quoted if necessary, and never as a formula.
    pub fn text(&mut self, text: &str) -> Result<()> {
        Ok(self.csv.write_field(&*escape_formula(text))?)
    }

    /// Ends the row.
    pub fn end_row(&mut self) -> Result<()> {
        Ok(self.csv.write_record(None::<&[u8]>)?)
    }

    /// Ends the table.
    pub fn finish(mut self) -> Result<()> {
        self.csv.flush()
    }
}

/// A row of a table as text, for tables that are displayed before they are written: cells with separators are quoted, and none
/// is a formula.
pub fn csv_row<S: AsRef<str>>(cells: &[S]) -> String {
    let quoted = cells.iter().map(|cell| {
        let cell = escape_formula(cell.as_ref());
        match cell.contains([',', '"', '\n', '\r']) {
            true => format!("\"{}\"", cell.replace('"', "\"\"")),
            false => cell.into_owned(),
        }
    });
    quoted.collect::<Vec<_>>().join(",") + "\n"
}

fn invalid(message: String) -> Error {
    Error::new(ErrorKind::InvalidInput, message)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_are_quoted_and_are_no_formulas() {
        assert_eq!(csv_row(&["=1+1"]), "'=1+1\n");
        assert_eq!(csv_row(&["-1.5"]), "-1.5\n");
        assert_eq!(csv_row(&["a, \"b\"", ""]), "\"a, \"\"b\"\"\",\n");
    }
}

//! Tables on the terminal.

use comfy_table::{Cell, CellAlignment, Table, presets};

use tautline_workflow::column::{Column, cells, headings};
pub use tautline_workflow::wording::units::mm;

use crate::output::say;

/// The rows of a table whose columns are stated next.
pub struct Rows<I>(I);

/// Begins a table with one row for each item.
pub fn rows<I: IntoIterator>(rows: I) -> Rows<I> {
    Rows(rows)
}

impl<I: IntoIterator> Rows<I> {
    /// The table of these columns; the first is text, the others are numbers.
    pub fn table(self, columns: &[Column<'_, I::Item>]) -> Table {
        let mut table = numbers(&headings(columns));
        for row in self.0 {
            push(&mut table, &cells(columns, &row));
        }
        table
    }

    /// Prints the table of these columns; the first is text, the others are numbers.
    pub fn print(self, columns: &[Column<'_, I::Item>]) {
        say!("{}", self.table(columns));
    }

    /// Prints the table of these columns, all of which are text.
    pub fn print_texts(self, columns: &[Column<'_, I::Item>]) {
        let mut table = texts(&headings(columns));
        for row in self.0 {
            table.add_row(cells(columns, &row));
        }
        say!("{table}");
    }
}

/// A table with a header whose columns are all text.
pub fn texts(header: &[&str]) -> Table {
    let mut table = Table::new();
    table.load_style(presets::NOTHING);
    table.set_header(header);
    table
}

/// A table with a header; the first column is text, the others are numbers.
pub fn numbers(header: &[&str]) -> Table {
    let mut table = Table::new();
    table.load_style(presets::NOTHING);
    table.set_header(header.iter().enumerate().map(|(k, text)| aligned(k, text)));
    table
}

/// Adds a row in the alignment of [`numbers`].
pub fn push(table: &mut Table, cells: &[String]) {
    table.add_row(cells.iter().enumerate().map(|(k, text)| aligned(k, text)));
}

fn aligned(column: usize, text: &str) -> Cell {
    let alignment = if column == 0 {
        CellAlignment::Left
    } else {
        CellAlignment::Right
    };
    Cell::new(text).set_alignment(alignment)
}

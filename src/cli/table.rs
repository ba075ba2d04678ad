//! Tables on the terminal.

use comfy_table::{Cell, CellAlignment, Table, presets};

pub use tautline_workflow::wording::units::mm;

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

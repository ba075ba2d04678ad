//! Columns of tables, for commands and reports.

/// A column: its heading, and its cell in a row.
pub type Column<'a, R> = (&'a str, &'a dyn Fn(&R) -> String);

/// The headings of columns.
#[must_use]
pub fn headings<'a, R>(columns: &[Column<'a, R>]) -> Vec<&'a str> {
    columns.iter().map(|(heading, _)| *heading).collect()
}

/// The cells of a row.
#[must_use]
pub fn cells<R>(columns: &[Column<'_, R>], row: &R) -> Vec<String> {
    columns.iter().map(|(_, cell)| cell(row)).collect()
}

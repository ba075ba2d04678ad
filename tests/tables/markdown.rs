//! Tables in Markdown.

use std::fmt::{Display, Write as _};

/// A table whose cells are texts between bars.
#[derive(Debug, Clone)]
pub struct Table {
    text: String,
}

impl Table {
    /// A table with these titles between bars, all columns on the left.
    #[must_use]
    pub fn new(titles: &str) -> Self {
        Self::aligned("l", titles)
    }

    /// A table of numbers on the right, with names in the first column.
    #[must_use]
    pub fn of_numbers(titles: &str) -> Self {
        Self::aligned("lr", titles)
    }

    /// A table with columns on the left `l` or right `r`; the last letter is that of all further columns.
    #[must_use]
    pub fn aligned(alignment: &str, titles: &str) -> Self {
        let columns = titles.matches('|').count() + 1;
        let last = alignment.chars().last().into_iter().cycle();
        let sides = alignment.chars().chain(last).take(columns);
        let rule = sides.map(|side| if side == 'r' { "--:|" } else { "---|" });
        Self {
            text: format!("| {titles} |\n|{}\n", rule.collect::<String>()),
        }
    }

    /// Adds a row of texts between bars.
    pub fn row(&mut self, cells: impl Display) {
        // Writing to a string cannot fail.
        let _ = writeln!(self.text, "| {cells} |");
    }

    /// The table with all its rows.
    #[must_use]
    pub fn text(self) -> String {
        self.text
    }
}

/// A table on the left with its rows.
pub fn table<C: Display>(titles: &str, rows: impl IntoIterator<Item = C>) -> String {
    let mut table = Table::new(titles);
    rows.into_iter().for_each(|row| table.row(row));
    table.text()
}

/// The text with the columns of its tables padded to equal widths, and no bars at either end.
#[must_use]
pub fn padded(text: &str) -> String {
    let lines: Vec<&str> = text.lines().collect();
    let parts = lines.chunk_by(|a, b| a.starts_with('|') == b.starts_with('|'));
    let parts = parts.map(|part| match part[0].starts_with('|') {
        true => padded_table(part),
        false => part.join("\n"),
    });
    parts.collect::<Vec<_>>().join("\n")
}

/// The rows of one table; the last column, which may have sentences, stays as it is.
fn padded_table(rows: &[&str]) -> String {
    let cells = |row: &&str| -> Vec<String> {
        let cells = row.trim_matches('|').split('|');
        cells.map(|cell| cell.trim().to_owned()).collect()
    };
    let mut rows: Vec<Vec<String>> = rows.iter().map(cells).collect();
    // The rule below the titles is as wide as the columns.
    rows[1].fill(String::new());
    let length = |cell: &String| cell.chars().count();
    let widest = |k: usize| rows.iter().map(|row| length(&row[k])).max().unwrap_or(0);
    let last = rows[0].len() - 1;
    let widths: Vec<usize> = (0..last).map(widest).chain([0]).collect();
    let lines = rows.iter().enumerate().map(|(number, row)| {
        let (fill, bar) = if number == 1 {
            ("-", "-|-")
        } else {
            (" ", " | ")
        };
        let padded = row.iter().zip(&widths).map(|(cell, &width)| {
            let missing = width.saturating_sub(length(cell));
            format!("{cell}{}", fill.repeat(missing))
        });
        let line = padded.collect::<Vec<_>>().join(bar);
        line.trim_end().to_owned()
    });
    lines.collect::<Vec<_>>().join("\n")
}

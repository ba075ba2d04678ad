//! The content of a report, independent of the file format.

use crate::column::{Column, cells, headings};
use crate::plot::Drawing;

/// A whole report.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Document {
    /// Printed at the head of every page; empty on most.
    pub marking: &'static str,
    /// What names the document at the foot of every page, in place of the title; empty on most.
    pub reference: String,
    /// A line above the title; may be empty.
    pub header: String,
    /// Title.
    pub title: String,
    /// Lines below the title.
    pub subtitle: Vec<String>,
    /// Its parts.
    pub sections: Vec<Section>,
}

impl Document {
    /// What stands at the foot of every page: the reference, or the title.
    #[must_use]
    pub fn foot(&self) -> &str {
        match self.reference.as_str() {
            "" => &self.title,
            reference => reference,
        }
    }
}

/// A section with a heading.
#[derive(Debug, Clone, PartialEq)]
pub struct Section {
    /// Its heading.
    pub title: String,
    /// Its content, in order.
    pub blocks: Vec<Block>,
}

/// An element of a section.
#[derive(Debug, Clone, PartialEq)]
pub enum Block {
    /// A heading inside the section.
    Heading(String),
    /// The main sentence of the section.
    Lead(String),
    /// A paragraph of text.
    Paragraph(String),
    /// Small print.
    Note(String),
    /// A list of short lines.
    List(Vec<String>),
    /// Names with their values.
    Facts(Vec<(String, String)>),
    /// A table.
    Table(Table),
    /// Plots, side by side if there is room.
    Plots(Vec<Drawing>),
    /// Lines for signatures: their purpose, and the name if it is known.
    Signatures(Vec<(String, String)>),
    /// A picture.
    Picture {
        /// PNG.
        png: Vec<u8>,
        /// What it shows.
        caption: String,
    },
}

/// Alignment of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Align {
    /// Text.
    Left,
    /// Numbers.
    Right,
}

/// A table. Every row has one cell for each column.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// Caption.
    pub caption: String,
    /// Headings and alignments of the columns.
    pub columns: Vec<(String, Align)>,
    /// Cells, row by row.
    pub rows: Vec<Vec<String>>,
}

impl Table {
    /// A table whose first `texts` columns are text, the others numbers.
    pub fn new(caption: impl Into<String>, texts: usize, headings: &[&str]) -> Self {
        let align = |k| if k < texts { Align::Left } else { Align::Right };
        let headings = headings.iter().enumerate();
        Self {
            caption: caption.into(),
            columns: headings
                .map(|(k, text)| ((*text).to_owned(), align(k)))
                .collect(),
            rows: Vec::new(),
        }
    }

    /// A table with one row for each item, whose columns are stated next.
    pub fn of<I: IntoIterator>(caption: impl Into<String>, texts: usize, rows: I) -> Rows<I> {
        let caption = caption.into();
        Rows {
            caption,
            texts,
            rows,
        }
    }

    /// Adds a row.
    pub fn push<const N: usize>(&mut self, cells: [String; N]) {
        debug_assert_eq!(N, self.columns.len(), "one cell for each column");
        self.rows.push(cells.map(with_minus).into());
    }

    /// Whether it has no row.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }
}

/// The rows of a table before its columns.
pub struct Rows<I> {
    caption: String,
    texts: usize,
    rows: I,
}

impl<I: IntoIterator> Rows<I> {
    /// The table of these columns.
    pub fn columns(self, columns: &[Column<'_, I::Item>]) -> Table {
        let mut table = Table::new(self.caption, self.texts, &headings(columns));
        for row in self.rows {
            let cells = cells(columns, &row).into_iter();
            table.rows.push(cells.map(with_minus).collect());
        }
        table
    }
}

impl Section {
    /// A section without content.
    pub fn new(title: impl Into<String>) -> Self {
        Self {
            title: title.into(),
            blocks: Vec::new(),
        }
    }

    /// Adds a heading.
    pub fn heading(&mut self, text: impl Into<String>) {
        self.blocks.push(Block::Heading(with_minus(text)));
    }

    /// Adds the sentence that carries the section.
    pub fn lead(&mut self, text: impl Into<String>) {
        self.blocks.push(Block::Lead(with_minus(text)));
    }

    /// Adds a paragraph.
    pub fn paragraph(&mut self, text: impl Into<String>) {
        self.blocks.push(Block::Paragraph(with_minus(text)));
    }

    /// Adds small print.
    pub fn note(&mut self, text: impl Into<String>) {
        self.blocks.push(Block::Note(with_minus(text)));
    }

    /// Adds a list, if it is not empty.
    pub fn list(&mut self, lines: Vec<String>) {
        if !lines.is_empty() {
            let lines = lines.into_iter().map(with_minus);
            self.blocks.push(Block::List(lines.collect()));
        }
    }

    /// Adds names with their values.
    pub fn facts(&mut self, facts: impl IntoIterator<Item = (String, String)>) {
        let facts = facts.into_iter();
        let facts = facts.map(|(name, value)| (name, with_minus(value)));
        self.blocks.push(Block::Facts(facts.collect()));
    }

    /// Adds a table, if it has rows.
    pub fn table(&mut self, table: Table) {
        if !table.is_empty() {
            self.blocks.push(Block::Table(table));
        }
    }
}

/// A text whose numbers have a minus, which is as wide as a plus, and not the hyphen of words and dates.
fn with_minus(text: impl Into<String>) -> String {
    let text = text.into();
    let mut before = ' ';
    let mut rest = text.chars().peekable();
    let mut typeset = String::with_capacity(text.len());
    while let Some(sign) = rest.next() {
        let is_before_digit = rest.peek().is_some_and(char::is_ascii_digit);
        let is_minus = sign == '-' && is_before_digit && !before.is_alphanumeric();
        typeset.push(if is_minus { '\u{2212}' } else { sign });
        before = sign;
    }
    typeset
}

#[cfg(test)]
mod tests {
    use super::with_minus;

    #[test]
    fn numbers_have_a_minus_and_words_and_dates_a_hyphen() {
        let text = "cable-3 on 2026-11-24: -0.5 mm (-1.2 to -0.1)";
        let expected = "cable-3 on 2026-11-24: \u{2212}0.5 mm (\u{2212}1.2 to \u{2212}0.1)";
        assert_eq!(with_minus(text), expected);
    }
}

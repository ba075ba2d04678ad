//! Rows of the table: cells with their numbers, sorted and filtered.

use std::cmp::Ordering;
use std::sync::Arc;

use tautline_workflow::identification::{
    Cell, Identification, READINGS, VALUES, reading_statistics, value_statistics,
};

use crate::model::Selection;
use crate::model::plot_preparation::same;

/// Width of a character (points).
const CHARACTER: f32 = 7.2;
/// Room beside a title for the sort icon (characters).
const SIGN: usize = 2;

/// Content of the table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) enum StatisticsKind {
    #[default]
    Readings,
    /// Identified values.
    Values,
}

impl StatisticsKind {
    /// Both contents, with their titles.
    pub(crate) const ALL: [(Self, &'static str); 2] =
        [(Self::Readings, "Readings"), (Self::Values, "Values")];

    /// Number of columns, from the first, that name the row.
    pub(crate) fn names(self) -> usize {
        match self {
            Self::Readings => 2,
            Self::Values => 1,
        }
    }
}

/// Heading of a column.
#[derive(Debug, Clone)]
pub(crate) struct Heading {
    pub(crate) title: &'static str,
    /// Explanation of the column.
    pub(crate) help: &'static str,
    /// Whether the column is right-aligned.
    pub(crate) is_number: bool,
    /// Width (points).
    pub(crate) width: f32,
}

/// Headings and all rows of a table.
#[derive(Debug, Default)]
pub(crate) struct Listing {
    pub(crate) heads: Vec<Heading>,
    pub(crate) rows: Vec<StatisticsRow>,
}

/// Row with its cells, the numbers to sort by (cells without a number are sorted by text), and its selection.
#[derive(Debug, Clone)]
pub(crate) struct StatisticsRow {
    /// Displayed texts.
    pub(crate) cells: Vec<String>,
    keys: Vec<Option<f64>>,
    /// Selection after a click.
    pub(crate) selects: Selection,
    /// Whether the row is a suspect reading.
    pub(crate) is_suspect: bool,
}

/// Sort order of a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Order {
    /// Index of the column.
    pub(crate) column: usize,
    /// Whether the largest value comes first.
    pub(crate) descending: bool,
}

/// Inputs of the rows.
#[derive(Debug, Clone)]
pub(crate) struct ListingKey {
    pub(crate) kind: StatisticsKind,
    pub(crate) fit: Arc<Identification>,
}

impl PartialEq for ListingKey {
    fn eq(&self, other: &Self) -> bool {
        self.kind == other.kind && same(Some(&self.fit), Some(&other.fit))
    }
}

/// Number of cells searched by the filter: pose and reading, or value and unit. Numbers are found by sorting.
const NAMES: usize = 2;

/// Indices of the rows whose names contain every word of the filter, in order.
pub(crate) fn arranged(rows: &[StatisticsRow], order: Option<Order>, filter: &str) -> Vec<usize> {
    let words: Vec<&str> = filter.split_whitespace().collect();
    let is_wanted = |row: &StatisticsRow| {
        let text = row.cells[..NAMES].join(" ").to_lowercase();
        words.iter().all(|word| text.contains(word))
    };
    let mut places: Vec<usize> = (0..rows.len()).filter(|k| is_wanted(&rows[*k])).collect();
    if let Some(Order { column, descending }) = order {
        places.sort_by(|a, b| compared(&rows[*a], &rows[*b], column, descending));
    }
    places
}

/// Compares two rows; those without a number come last in both directions.
fn compared(a: &StatisticsRow, b: &StatisticsRow, column: usize, descending: bool) -> Ordering {
    let directed = |order: Ordering| if descending { order.reverse() } else { order };
    match (a.keys[column], b.keys[column]) {
        (Some(a), Some(b)) => directed(a.total_cmp(&b)),
        (Some(_), None) => Ordering::Less,
        (None, Some(_)) => Ordering::Greater,
        (None, None) => directed(a.cells[column].cmp(&b.cells[column])),
    }
}

/// Table as tab-separated text, for a spreadsheet.
pub(crate) fn text(heads: &[Heading], rows: &[StatisticsRow], shown: &[usize]) -> String {
    let titles: Vec<&str> = heads.iter().map(|head| head.title).collect();
    let mut text = titles.join("\t") + "\n";
    for place in shown {
        text += &rows[*place].cells.join("\t").replace('\u{2212}', "-");
        text.push('\n');
    }
    text
}

/// Table with all rows, in the original order.
pub(crate) fn listing(of: &ListingKey) -> Listing {
    match of.kind {
        StatisticsKind::Readings => table(&READINGS, reading_statistics(&of.fit), |one| {
            let (cable, pose) = (one.cable, Some(one.pose));
            (one.cells(), Selection { cable, pose }, one.is_suspect)
        }),
        StatisticsKind::Values => table(&VALUES, value_statistics(&of.fit), |one| {
            let selects = one.cable.map(Selection::cable).unwrap_or_default();
            (one.cells(), selects, false)
        }),
    }
}

/// Table from items: `row` returns the cells of an item, its selection, and whether it is suspect.
fn table<T, const N: usize>(
    columns: &[[&'static str; 3]; N],
    all: Vec<T>,
    row: impl Fn(&T) -> ([Cell; N], Selection, bool),
) -> Listing {
    let is_shown = |title: &str| !title.is_empty();
    let row = |one: T| {
        let (cells, selects, is_suspect) = row(&one);
        let cells = columns.iter().zip(cells);
        let cells = cells.filter(|([_, title, _], _)| is_shown(title));
        let cells = cells.map(|(_, cell)| match cell {
            Cell::Text([_, text]) => (None, text),
            Cell::Number([_, shown], text) => (shown, text),
        });
        let (keys, cells) = cells.unzip();
        StatisticsRow {
            cells,
            keys,
            selects,
            is_suspect,
        }
    };
    let rows: Vec<StatisticsRow> = all.into_iter().map(row).collect();
    let head = |(place, [_, title, help]): (usize, &[&'static str; 3])| {
        let lengths = rows.iter().map(|row| row.cells[place].chars().count());
        Heading {
            title,
            help,
            is_number: rows.iter().any(|row| row.keys[place].is_some()),
            width: CHARACTER * lengths.fold(title.len() + SIGN, usize::max) as f32,
        }
    };
    let shown = columns.iter().filter(|[_, title, _]| is_shown(title));
    let heads = shown.enumerate().map(head).collect();
    Listing { heads, rows }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows() -> Vec<StatisticsRow> {
        let of = |name: &str, value: Option<f64>| {
            let shown = value.map_or_else(|| "\u{2013}".to_owned(), |v| format!("{v:.1}"));
            StatisticsRow {
                cells: vec![name.to_owned(), shown.replace('-', "\u{2212}")],
                keys: vec![None, value],
                selects: Selection::default(),
                is_suspect: false,
            }
        };
        vec![
            of("Length of cable-2", Some(-3.0)),
            of("Laser distance", None),
            of("Length of cable-1", Some(10.0)),
            of("Length of cable-3", Some(2.0)),
        ]
    }

    #[test]
    fn numbers_are_sorted_as_numbers_and_what_is_missing_is_last() {
        let rows = rows();
        let by = |column, descending| {
            let order = Order { column, descending };
            arranged(&rows, Some(order), "")
        };
        assert_eq!(by(1, false), [0, 3, 2, 1]);
        assert_eq!(by(1, true), [2, 3, 0, 1]);
        assert_eq!(by(0, false), [1, 2, 0, 3]);
        assert_eq!(arranged(&rows, None, ""), [0, 1, 2, 3]);
        assert_eq!(arranged(&rows, None, "length cable-3"), [3]);
    }

    #[test]
    fn copied_numbers_have_signs_that_spreadsheets_read() {
        let heads = ["Reading", "N"].map(|title| Heading {
            title,
            help: "",
            is_number: false,
            width: 1.0,
        });
        let text = text(&heads, &rows(), &[0, 1]);
        assert_eq!(
            text,
            "Reading\tN\nLength of cable-2\t-3.0\nLaser distance\t\u{2013}\n"
        );
    }
}

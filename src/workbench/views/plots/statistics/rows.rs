//! The rows of the table: cells with the numbers behind them, sorted and filtered.

use std::cmp::Ordering;
use std::sync::Arc;

use tautline_core::robot::Robot;
use tautline_workflow::identification::{
    Identification, ReadingStatistics, ValueStatistics, reading_statistics, value_statistics,
};
use tautline_workflow::wording::sentence;
use tautline_workflow::wording::units::{decimals, display_unit, fixed, signed, significant};

use crate::model::Selection;
use crate::model::plot_preparation::same;

/// What the table lists.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Listed {
    #[default]
    Readings,
    /// All identified values.
    Values,
}

impl Listed {
    /// Both with their titles.
    pub const ALL: [(Self, &'static str); 2] =
        [(Self::Readings, "Readings"), (Self::Values, "Values")];

    /// How many of its columns, from the first on, say what a row is.
    pub fn names(self) -> usize {
        match self {
            Self::Readings => 2,
            Self::Values => 1,
        }
    }

    /// Its columns.
    pub fn heads(self) -> &'static [Head] {
        match self {
            Self::Readings => &READINGS,
            Self::Values => &VALUES,
        }
    }
}

/// The heading of a column.
pub struct Head {
    pub title: &'static str,
    /// What the numbers of the column are.
    pub help: &'static str,
    /// Whether it stands at the right.
    pub is_number: bool,
    /// Width at first (points).
    pub width: f32,
}

impl Head {
    const fn words(title: &'static str, width: f32, help: &'static str) -> Self {
        Self {
            title,
            help,
            is_number: false,
            width,
        }
    }

    const fn number(title: &'static str, width: f32, help: &'static str) -> Self {
        Self {
            is_number: true,
            ..Self::words(title, width, help)
        }
    }
}

static READINGS: [Head; 10] = [
    Head::number("Pose", 44.0, "Number of the pose"),
    Head::words("Reading", 150.0, "What was read"),
    Head::words(
        "Unit",
        58.0,
        "Unit of the residual, the standard deviation and the smallest detectable error",
    ),
    Head::number("Residual", 66.0, "Prediction minus reading"),
    Head::number(
        "Sd",
        54.0,
        "Standard deviation of the reading, as described",
    ),
    Head::number(
        "Redundancy",
        80.0,
        "Share of an error of this reading that shows in its residual: 0 is not checked by any other reading, 1 completely",
    ),
    Head::number(
        "Standardised",
        88.0,
        "Residual in its own standard deviations: beyond 3 in 3 of 1000 readings if model and noise are right",
    ),
    Head::number(
        "Detectable",
        80.0,
        "Smallest error of this reading that the test for suspicious readings finds with 80 % probability",
    ),
    Head::number(
        "Influence mm",
        92.0,
        "How far an error of that size moves the pulley that it moves most",
    ),
    Head::words(
        "On pulley",
        80.0,
        "The pulley that such an error moves most",
    ),
];

static VALUES: [Head; 8] = [
    Head::words("Value", 230.0, "What was identified"),
    Head::words("Unit", 70.0, "Unit of all numbers of the row"),
    Head::number("Nominal", 84.0, "As the description of the robot has it"),
    Head::number("Identified", 84.0, "As identified"),
    Head::number("Difference", 80.0, "Identified minus nominal"),
    Head::number("Sd", 70.0, "Standard deviation of the identified value"),
    Head::number(
        "Prior sd",
        70.0,
        "Standard deviation before anything was measured",
    ),
    Head::words(
        "95 % interval",
        150.0,
        "The true value lies in it with 95 % probability, if the model explains the data",
    ),
];

/// A row: its cells, the numbers to sort by (cells without one by their text), and what it selects.
#[derive(Debug, Clone)]
pub struct Row {
    /// What is shown.
    pub cells: Vec<String>,
    keys: Vec<Option<f64>>,
    /// What a click selects.
    pub selects: Selection,
    /// Whether it is a reading that does not fit.
    pub is_suspect: bool,
}

/// By which column a table is sorted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Order {
    /// Its place.
    pub column: usize,
    /// Whether the largest come first.
    pub descending: bool,
}

/// What the rows depend on.
#[derive(Debug, Clone)]
pub struct Of {
    pub listed: Listed,
    pub fit: Arc<Identification>,
}

impl PartialEq for Of {
    fn eq(&self, other: &Self) -> bool {
        self.listed == other.listed && same(Some(&self.fit), Some(&other.fit))
    }
}

/// Cells that a filter looks at: pose and reading, or value and unit. Numbers are found by sorting.
const NAMES: usize = 2;

/// The places of the rows whose names contain every word of the filter, in order.
pub fn arranged(rows: &[Row], order: Option<Order>, filter: &str) -> Vec<usize> {
    let words: Vec<&str> = filter.split_whitespace().collect();
    let is_wanted = |row: &Row| {
        let text = row.cells[..NAMES].join(" ").to_lowercase();
        words.iter().all(|word| text.contains(word))
    };
    let mut places: Vec<usize> = (0..rows.len()).filter(|k| is_wanted(&rows[*k])).collect();
    if let Some(Order { column, descending }) = order {
        places.sort_by(|a, b| compared(&rows[*a], &rows[*b], column, descending));
    }
    places
}

/// Rows without a number stand last whatever the direction.
fn compared(a: &Row, b: &Row, column: usize, descending: bool) -> Ordering {
    let directed = |order: Ordering| if descending { order.reverse() } else { order };
    match (a.keys[column], b.keys[column]) {
        (Some(a), Some(b)) => directed(a.total_cmp(&b)),
        (Some(_), None) => Ordering::Less,
        (None, Some(_)) => Ordering::Greater,
        (None, None) => directed(a.cells[column].cmp(&b.cells[column])),
    }
}

/// The table as text for a spreadsheet: cells apart by tabs.
pub fn text(heads: &[Head], rows: &[Row], shown: &[usize]) -> String {
    let titles: Vec<&str> = heads.iter().map(|head| head.title).collect();
    let mut text = titles.join("\t") + "\n";
    for place in shown {
        text += &rows[*place].cells.join("\t").replace('\u{2212}', "-");
        text.push('\n');
    }
    text
}

/// All rows, as they were measured.
pub fn rows_of(of: &Of) -> Vec<Row> {
    match of.listed {
        Listed::Readings => reading_statistics(&of.fit)
            .iter()
            .map(|one| reading(&of.fit.dataset.robot, one))
            .collect(),
        Listed::Values => value_statistics(&of.fit).iter().map(value).collect(),
    }
}

/// A cell with the number that it shows.
type Keyed = (String, Option<f64>);

fn row(cells: impl IntoIterator<Item = Keyed>, selects: Selection, is_suspect: bool) -> Row {
    let (cells, keys) = cells.into_iter().unzip();
    Row {
        cells,
        keys,
        selects,
        is_suspect,
    }
}

fn words(text: impl Into<String>) -> Keyed {
    (text.into(), None)
}

fn number(value: Option<f64>, shown: impl FnOnce(f64) -> String) -> Keyed {
    let value = value.filter(|value| value.is_finite());
    let text = value.map_or_else(|| "\u{2013}".to_owned(), shown);
    (text.replace('-', "\u{2212}"), value)
}

fn reading(robot: &Robot, one: &ReadingStatistics) -> Row {
    let (factor, unit) = display_unit(one.unit);
    let sd = factor * one.sd;
    let digits = if sd > 0.0 { decimals(sd) + 1 } else { 3 };
    let moves = one.moves.and_then(|cable| robot.cables.get(cable));
    let cells = [
        number(Some(one.pose as f64), |pose| fixed(pose, 0)),
        words(sentence(&one.name)),
        words(unit),
        number(Some(factor * one.residual), |v| signed(v, digits)),
        number(Some(sd), |v| significant(v, 3)),
        number(one.redundancy, |v| fixed(v, 3)),
        number(one.normalised, |v| signed(v, 2)),
        number(one.smallest_error.map(|v| factor * v), |v| fixed(v, digits)),
        number(one.influence_m.map(|v| 1e3 * v), |v| fixed(v, 2)),
        words(moves.map_or("", |cable| cable.name.as_str())),
    ];
    let selects = Selection {
        cable: one.cable,
        pose: Some(one.pose),
    };
    row(cells, selects, one.is_suspect)
}

fn value(one: &ValueStatistics) -> Row {
    let (factor, unit) = display_unit(one.unit);
    let sd = one.sd.map(|sd| factor * sd).filter(|sd| *sd > 0.0);
    let digits = sd.map_or(3, |sd| decimals(sd).min(6));
    let scaled = |value: Option<f64>| value.map(|value| factor * value);
    let difference = one.nominal.map(|nominal| factor * (one.value - nominal));
    let interval = one.interval.map(|ends| {
        let [from, to] = ends.map(|end| fixed(factor * end, digits).replace('-', "\u{2212}"));
        format!("{from} to {to}")
    });
    let cells = [
        words(sentence(&one.name)),
        words(unit),
        number(scaled(one.nominal), |v| fixed(v, digits)),
        number(Some(factor * one.value), |v| fixed(v, digits)),
        number(difference, |v| signed(v, digits)),
        number(sd, |v| fixed(v, digits)),
        number(scaled(one.prior_sd), |v| significant(v, 3)),
        words(interval.unwrap_or_else(|| "\u{2013}".to_owned())),
    ];
    row(
        cells,
        one.cable.map(Selection::cable).unwrap_or_default(),
        false,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows() -> Vec<Row> {
        let of = |name: &str, value: Option<f64>| {
            let cells = [words(name), number(value, |v| fixed(v, 1))];
            row(cells, Selection::default(), false)
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
        let heads = [Head::words("Reading", 1.0, ""), Head::number("N", 1.0, "")];
        let text = text(&heads, &rows(), &[0, 1]);
        assert_eq!(
            text,
            "Reading\tN\nLength of cable-2\t-3.0\nLaser distance\t\u{2013}\n"
        );
    }
}

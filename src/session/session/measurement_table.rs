//! Measurements as JSON: columns named as in `poses.csv`.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use tautline_core::measurement::Measurements;
use tautline_core::robot::FieldError;
use tautline_files::quoted;

use crate::error::fail;
use crate::poses::{Columns, Fault, GROUP, LABEL, PoseColumn};

/// Measurements by column; all columns have the length of the labels.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub(crate) struct MeasurementTable {
    /// Labels of the poses, 0 for the home pose.
    #[serde(default)]
    pose: Vec<i64>,
    /// Group labels: poses with the same label were read in one standstill or run; an empty label means no group.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    group: Vec<String>,
    /// Numeric columns by their name in `poses.csv`; null: not measured.
    #[serde(default)]
    columns: BTreeMap<String, Vec<Option<f64>>>,
    /// Unknown text columns, in the order of the file.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    other: Vec<TextColumn>,
}

/// A text column.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
struct TextColumn {
    /// Its name.
    name: String,
    /// Its cells.
    cells: Vec<String>,
}

impl MeasurementTable {
    /// The table of measurements.
    pub fn of(measurements: &Measurements) -> Self {
        let columns = Columns::of(measurements);
        let nullable = |values: Vec<f64>| {
            let values = values.into_iter();
            values.map(|v| Some(v).filter(|v| !v.is_nan())).collect()
        };
        Self {
            pose: columns.labels,
            group: columns.groups,
            columns: columns
                .numbers
                .into_iter()
                .map(|(column, values)| (column.name(), nullable(values)))
                .collect(),
            other: columns
                .other
                .into_iter()
                .map(|(name, cells)| TextColumn { name, cells })
                .collect(),
        }
    }

    /// Checks names and lengths of the columns.
    pub fn check(&self) -> Result<(), FieldError> {
        let rows = self.pose.len();
        let check_rows = |pointer: String, found: usize| match found == rows {
            true => Ok(()),
            false => {
                let message = format!("found {found} values, expected {rows} as in /pose");
                fail(pointer, message)
            }
        };
        if !self.group.is_empty() {
            check_rows(format!("/{GROUP}"), self.group.len())?;
        }
        for (name, values) in &self.columns {
            let pointer = pointer(name, None);
            if PoseColumn::parse(name).is_none() {
                let message = format!("found {}, expected a column of poses.csv", quoted(name));
                return fail(pointer, message);
            }
            check_rows(pointer, values.len())?;
        }
        for (k, column) in self.other.iter().enumerate() {
            check_rows(format!("/other/{k}/cells"), column.cells.len())?;
        }
        Ok(())
    }

    /// Labels of the poses.
    pub fn labels(&self) -> &[i64] {
        &self.pose
    }

    /// The cells of its first row that are not empty, by column.
    pub fn cells(&self) -> BTreeMap<String, Value> {
        let numbers = self.columns.iter().filter_map(|(name, values)| {
            let value = values.first().copied().flatten()?;
            Some((name.clone(), value.into()))
        });
        let group = self.group.first().map(|group| (GROUP, group));
        let others = self.other.iter();
        let others = others.filter_map(|one| Some((one.name.as_str(), one.cells.first()?)));
        let texts = group.into_iter().chain(others);
        let texts = texts.filter(|(_, text)| !text.is_empty());
        let texts = texts.map(|(name, text)| (name.to_owned(), text.as_str().into()));
        numbers.chain(texts).collect()
    }

    /// The table without the columns whose cells are all empty, and without those whose names begin with `prefix`.
    pub fn filled(mut self, prefix: &str) -> Self {
        self.columns
            .retain(|name, values| !name.starts_with(prefix) && values.iter().any(Option::is_some));
        self.other
            .retain(|column| column.cells.iter().any(|cell| !cell.is_empty()));
        if self.group.iter().all(String::is_empty) {
            self.group.clear();
        }
        self
    }

    /// Whether `other` contains all numbers of this table.
    pub fn is_contained_in(&self, other: &Self) -> bool {
        let mut columns = self.columns.iter();
        columns.all(|(name, values)| {
            let missing = values.iter().all(Option::is_none);
            missing || other.columns.get(name) == Some(values)
        })
    }

    /// The columns of a table that passed its check.
    pub fn into_columns(self) -> Columns {
        let numbers = self.columns.into_iter().filter_map(|(name, values)| {
            let values = values.into_iter().map(|v| v.unwrap_or(f64::NAN));
            Some((PoseColumn::parse(&name)?, values.collect()))
        });
        let mut columns = Columns {
            labels: self.pose,
            groups: self.group,
            numbers: numbers.collect(),
            other: self.other.into_iter().map(|c| (c.name, c.cells)).collect(),
        };
        // Earlier versions stored group labels among the unknown columns.
        let unknown = columns.other.iter().position(|(name, _)| name == GROUP);
        if let Some(k) = unknown.filter(|_| columns.groups.is_empty()) {
            columns.groups = columns.other.remove(k).1;
        }
        columns
    }
}

impl From<Fault> for FieldError {
    /// The fault with a pointer into a [`MeasurementTable`].
    fn from(fault: Fault) -> Self {
        let message = match fault.earlier_row {
            Some(row) => format!("{} (value {row})", fault.message),
            None => fault.message,
        };
        Self {
            pointer: pointer(&fault.column, fault.row),
            message,
        }
    }
}

fn pointer(column: &str, row: Option<usize>) -> String {
    let row = row.map_or_else(String::new, |row| format!("/{row}"));
    if column == LABEL {
        format!("/{LABEL}{row}")
    } else {
        format!(
            "/columns/{}{row}",
            column.replace('~', "~0").replace('/', "~1")
        )
    }
}

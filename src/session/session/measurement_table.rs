//! Measurements as JSON: columns with the names of `poses.csv`.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tautline_core::measurement::Measurements;
use tautline_core::robot::{FieldError, Robot};

use crate::error::quoted;
use crate::poses::{Column, Columns, Fault, LABEL, assemble, check_plausible};

/// Measurements by column; all columns have as many values as there are labels.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub(crate) struct MeasurementTable {
    /// Labels of the poses, 0 for the home pose.
    #[serde(default)]
    pose: Vec<i64>,
    /// Columns of numbers by their name in `poses.csv`; null: not measured.
    #[serde(default)]
    columns: BTreeMap<String, Vec<Option<f64>>>,
    /// Columns of text that the program does not know, in the order of the file.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    other: Vec<TextColumn>,
}

/// A column of text.
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
        let fail = |pointer: String, message: String| Err(FieldError { pointer, message });
        let check_rows = |pointer: String, found: usize| {
            if found == rows {
                return Ok(());
            }
            fail(
                pointer,
                format!("found {found} values, expected {rows} as in /pose"),
            )
        };
        for (name, values) in &self.columns {
            let pointer = pointer(name, None);
            if Column::parse(name).is_none() {
                let message = format!("found {}, expected a column of poses.csv", quoted(name));
                return fail(pointer, message);
            }
            check_rows(pointer.clone(), values.len())?;
            if let Some(row) = values.iter().flatten().position(|v| !v.is_finite()) {
                return fail(pointer, format!("found an infinite value, number {row}"));
            }
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

    /// Whether `other` has all numbers that are here.
    pub fn is_contained_in(&self, other: &Self) -> bool {
        let mut columns = self.columns.iter();
        columns.all(|(name, values)| {
            let missing = values.iter().all(Option::is_none);
            missing || other.columns.get(name) == Some(values)
        })
    }

    /// The measurements, checked against the robot.
    pub fn into_measurements(self, robot: &Robot) -> Result<Measurements, FieldError> {
        self.build(robot).map_err(place_fault)
    }

    /// The measurements of one pose, checked against the robot, which come to stand in row `row`
    /// of a larger table.
    pub fn into_row(self, robot: &Robot, row: usize) -> Result<Measurements, FieldError> {
        self.check()?;
        self.build(robot).map_err(|fault| {
            place_fault(Fault {
                row: fault.row.map(|_| row),
                ..fault
            })
        })
    }

    fn build(self, robot: &Robot) -> Result<Measurements, Fault> {
        let numbers = self.columns.into_iter().filter_map(|(name, values)| {
            let values = values.into_iter().map(|v| v.unwrap_or(f64::NAN));
            Some((Column::parse(&name)?, values.collect()))
        });
        let columns = Columns {
            labels: self.pose,
            numbers: numbers.collect(),
            other: self.other.into_iter().map(|c| (c.name, c.cells)).collect(),
        };
        if columns.labels.is_empty() {
            return Ok(Measurements::default());
        }
        columns.check_header(robot)?;
        let measurements = assemble(columns, robot)?;
        check_plausible(&measurements, robot)?;
        Ok(measurements)
    }
}

fn place_fault(fault: Fault) -> FieldError {
    let message = match fault.earlier_row {
        Some(row) => format!("{} (value {row})", fault.message),
        None => fault.message,
    };
    FieldError {
        pointer: pointer(&fault.column, fault.row),
        message,
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

//! Datasets and results as tables for other programs.

mod dialects;
mod matlab;
mod parquet;

use std::path::Path;

use tautline_core::measurement::Measurements;
use tautline_session::{csv_row, pose_columns};

pub use self::parquet::{ParquetCells, parquet_file};
pub use dialects::{DialectError, DialectText, WrittenValue, dialect_text};

/// A table with named columns of one length.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Table {
    /// Name of the table, one word.
    pub name: &'static str,
    /// Name and cells of each column.
    pub columns: Vec<(String, Cells)>,
}

/// The cells of a column.
#[derive(Debug, Clone, PartialEq)]
pub enum Cells {
    /// Numbers; NaN where missing.
    Numbers(Vec<f64>),
    /// Texts.
    Texts(Vec<String>),
}

/// File format of tables.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TableFormat {
    /// Comma-separated, decimal points, empty cells for missing numbers.
    Csv,
    /// MATLAB version 5, one struct per table.
    Matlab,
    /// Apache Parquet.
    Parquet,
}

impl TableFormat {
    /// The format of a file according to its name.
    #[must_use]
    pub fn of(path: &Path) -> Option<Self> {
        match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
            "csv" => Some(Self::Csv),
            "mat" => Some(Self::Matlab),
            "parquet" => Some(Self::Parquet),
            _ => None,
        }
    }

    /// Whether one file can contain several tables.
    #[must_use]
    pub fn holds_several(self) -> bool {
        self == Self::Matlab
    }
}

impl Cells {
    fn len(&self) -> usize {
        match self {
            Self::Numbers(numbers) => numbers.len(),
            Self::Texts(texts) => texts.len(),
        }
    }

    /// A cell as text; empty for a missing number.
    fn text(&self, row: usize) -> String {
        match self {
            Self::Numbers(numbers) if numbers[row].is_nan() => String::new(),
            Self::Numbers(numbers) => numbers[row].to_string(),
            Self::Texts(texts) => texts[row].clone(),
        }
    }
}

impl Table {
    /// A table without columns.
    #[must_use]
    pub fn new(name: &'static str) -> Self {
        Self {
            name,
            columns: Vec::new(),
        }
    }

    /// Adds a column of numbers.
    #[must_use]
    pub fn numbers(mut self, name: &str, numbers: impl Iterator<Item = f64>) -> Self {
        let column = (name.to_owned(), Cells::Numbers(numbers.collect()));
        self.columns.push(column);
        self
    }

    /// Adds a column of numbers, some of which are unknown.
    #[must_use]
    pub fn known(self, name: &str, numbers: impl Iterator<Item = Option<f64>>) -> Self {
        self.numbers(name, numbers.map(|number| number.unwrap_or(f64::NAN)))
    }

    /// Adds a column of texts.
    #[must_use]
    pub fn texts(mut self, name: &str, texts: impl Iterator<Item = String>) -> Self {
        let column = (name.to_owned(), Cells::Texts(texts.collect()));
        self.columns.push(column);
        self
    }

    /// Number of rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.columns.first().map_or(0, |(_, cells)| cells.len())
    }

    /// The table as CSV.
    #[must_use]
    pub fn csv(&self) -> String {
        let names: Vec<String> = self.columns.iter().map(|(name, _)| name.clone()).collect();
        let mut text = csv_row(&names);
        for row in 0..self.rows() {
            let cells = self.columns.iter().map(|(_, cells)| cells.text(row));
            text += &csv_row(&cells.collect::<Vec<_>>());
        }
        text
    }
}

/// Measured poses, with the columns of `poses.csv`.
#[must_use]
pub fn poses_table(measurements: &Measurements) -> Table {
    let columns = pose_columns(measurements);
    let labels = columns.labels.iter().map(|label| *label as f64);
    let mut table = Table::new("poses").numbers("pose", labels);
    if !columns.groups.is_empty() {
        table = table.texts("group", columns.groups.into_iter());
    }
    for (name, values) in columns.numbers {
        table = table.numbers(&name, values.into_iter());
    }
    for (name, texts) in columns.texts {
        table = table.texts(&name, texts.into_iter());
    }
    table
}

/// The bytes of a file with one table, or with all of them if the format holds several.
///
/// # Errors
/// If the format does not allow it, as two columns with the same name in Parquet.
pub fn encode(format: TableFormat, tables: &[Table]) -> Result<Vec<u8>, String> {
    Ok(match format {
        TableFormat::Csv => tables
            .iter()
            .map(Table::csv)
            .collect::<String>()
            .into_bytes(),
        TableFormat::Matlab => matlab::file(tables),
        TableFormat::Parquet => {
            let columns = tables.iter().flat_map(|table| &table.columns);
            let columns = columns.map(|(name, cells)| {
                let cells = match cells {
                    Cells::Numbers(numbers) => ParquetCells::F64(numbers),
                    Cells::Texts(texts) => ParquetCells::Texts(texts),
                };
                (name.as_str(), cells)
            });
            let columns: Vec<_> = columns.collect();
            parquet_file(&columns, &[]).map_err(|error| error.to_string())?
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::samples::identified;
    use crate::identification::{readings_table, values_table};
    use tautline_import::read_source;

    fn tables() -> Vec<Table> {
        let fit = identified();
        let measurements = &fit.dataset.measurements;
        vec![
            poses_table(measurements),
            values_table(&fit),
            readings_table(&fit),
        ]
    }

    /// Numbers read back by the reader of foreign files are the same bits.
    #[test]
    fn tables_read_back_to_the_same_numbers() {
        let folder = tempfile::tempdir().expect("a folder");
        let tables = tables();
        let mut compared = 0;
        let mut compare = |format: TableFormat, file: &str, tables: &[Table]| {
            let path = folder.path().join(file);
            std::fs::write(&path, encode(format, tables).expect("encoded")).expect("written");
            let source = read_source(&path).expect("read");
            for table in tables {
                for (name, cells) in &table.columns {
                    let Cells::Numbers(numbers) = cells else {
                        continue;
                    };
                    let name = match format.holds_several() {
                        true => format!("{}.{name}", table.name),
                        false => name.clone(),
                    };
                    let mut series = source.series.iter();
                    let channel = series.find_map(|series| series.channel(&name));
                    let read = channel
                        .unwrap_or_else(|| panic!("{name} is missing"))
                        .values
                        .iter();
                    assert!(
                        read.map(f64::to_bits)
                            .eq(numbers.iter().map(|one| one.to_bits())),
                        "{name}"
                    );
                    compared += 1;
                }
            }
        };
        compare(TableFormat::Matlab, "all.mat", &tables);
        for table in tables {
            let file = format!("{}.parquet", table.name);
            compare(TableFormat::Parquet, &file, &[table]);
        }
        assert!(compared > 60, "{compared}");
    }

    #[test]
    fn poses_as_csv_are_the_poses_that_a_dataset_has() {
        let fit = identified();
        let measurements = &fit.dataset.measurements;
        let csv = poses_table(measurements).csv();
        let read = tautline_session::read_poses(csv.as_bytes(), "poses.csv", &fit.dataset.robot);
        assert_eq!(read.expect("read").value, *measurements);
    }
}

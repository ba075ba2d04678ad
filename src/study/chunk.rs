//! A chunk: the calibrations of one part of a study as columns of a file, with their origin.
//!
//! The file is Parquet, `pandas.read_parquet("chunk-3-of-7.parquet")`: one row for each calibration.

use std::fs::File;
use std::path::{Path, PathBuf};

use parquet::column::reader::get_typed_column_reader;
use parquet::data_type::{DataType, FloatType, Int32Type};
use parquet::errors::ParquetError;
use parquet::file::reader::{FileReader, RowGroupReader, SerializedFileReader};
use serde::{Deserialize, Serialize};
use tautline_files::read_damaged;
use tautline_session::{Fingerprint, write_bytes};
use tautline_workflow::exporting::{ParquetCells, parquet_file};

use crate::calibration::{Calibration, Outcome};
use crate::plan::StudyPlan;
use crate::{StudyError, VERSION};

/// Number of a chunk, from 1, and number of chunks into which the study is divided.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct ChunkNumber {
    /// Number of the chunk, from 1.
    pub number: u64,
    /// Number of chunks.
    pub of: u64,
}

impl ChunkNumber {
    /// Parses text such as `3/7`.
    ///
    /// # Errors
    /// If the text is malformed.
    pub fn parse(text: &str) -> Result<Self, String> {
        let parsed = text.split_once('/').and_then(|(number, of)| {
            Some(Self {
                number: number.trim().parse().ok()?,
                of: of.trim().parse().ok()?,
            })
        });
        parsed
            .filter(|part| part.number >= 1 && part.number <= part.of)
            .ok_or_else(|| {
                format!("found {text}, expected the number of a chunk and of all, such as 3/7")
            })
    }

    /// Half-open range of its calibrations among `all`; the sizes of chunks differ by at most one.
    #[must_use]
    pub fn range(self, all: u64) -> [u64; 2] {
        let before =
            |number: u64| (u128::from(all) * u128::from(number) / u128::from(self.of)) as u64;
        [before(self.number - 1), before(self.number)]
    }

    /// Name of its file.
    #[must_use]
    pub fn file_name(self) -> String {
        let digits = self.of.to_string().len();
        format!("chunk-{:0digits$}-of-{}.parquet", self.number, self.of)
    }
}

/// Origin of a chunk, stored with it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Origin {
    /// Fingerprint of the plan.
    pub study: String,
    /// Version of the program.
    pub version: String,
    /// Seed of the study.
    pub seed: u64,
    /// Number of the chunk.
    pub part: ChunkNumber,
    /// Half-open range of its calibrations.
    pub range: [u64; 2],
    /// Fingerprint of its columns.
    pub content: String,
}

impl Origin {
    /// The origin of a chunk of a plan with this fingerprint, computed by this version of the program.
    #[must_use]
    pub fn of((plan, fingerprint): (&StudyPlan, &str), part: ChunkNumber, rows: &Rows) -> Self {
        Self {
            study: fingerprint.to_owned(),
            version: VERSION.to_owned(),
            seed: plan.study.seed,
            part,
            range: part.range(plan.calibrations()),
            content: rows.fingerprint(),
        }
    }
}

/// Metadata key of the origin in the Parquet file.
const ORIGIN: &str = "tautline.origin";

/// Calibrations as columns.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Rows {
    /// Index of the cell.
    pub cell: Vec<u32>,
    /// As [`crate::calibration::Outcome`].
    pub outcome: Vec<u8>,
    /// Faults, one bit each.
    pub faults: Vec<u8>,
    /// As [`crate::calibration::Opinion`].
    pub opinion: Vec<u8>,
    /// Error of entry points (m).
    pub entry_m: Vec<f32>,
    /// Position error over the workspace (m).
    pub position_m: Vec<f32>,
    /// Accuracy of poses, ISO 9283 (m).
    pub accuracy_m: Vec<f32>,
    /// Chi-square.
    pub chi2: Vec<f32>,
    /// Degrees of freedom.
    pub degrees_of_freedom: Vec<f32>,
}

impl Rows {
    /// Adds a calibration.
    pub fn push(&mut self, cell: usize, calibration: &Calibration) {
        self.cell.push(cell as u32);
        self.outcome.push(calibration.outcome as u8);
        self.faults.push(calibration.faults);
        self.opinion.push(calibration.opinion as u8);
        self.entry_m.push(calibration.entry_m as f32);
        self.position_m.push(calibration.position_m as f32);
        self.accuracy_m.push(calibration.accuracy_m as f32);
        self.chi2.push(calibration.chi2 as f32);
        self.degrees_of_freedom
            .push(calibration.degrees_of_freedom as f32);
    }

    /// Number of calibrations.
    #[must_use]
    pub fn len(&self) -> usize {
        self.cell.len()
    }

    /// Whether there are no calibrations.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.cell.is_empty()
    }

    /// Whether a calibration converged.
    #[must_use]
    pub fn converged(&self, row: usize) -> bool {
        self.outcome[row] == Outcome::Converged as u8
    }

    /// The columns with their names.
    #[must_use]
    pub fn columns(&self) -> [(&'static str, ParquetCells<'_>); 9] {
        use ParquetCells::{F32, U8, U32};
        [
            ("cell", U32(&self.cell)),
            ("outcome", U8(&self.outcome)),
            ("faults", U8(&self.faults)),
            ("opinion", U8(&self.opinion)),
            ("entry_m", F32(&self.entry_m)),
            ("position_m", F32(&self.position_m)),
            ("accuracy_m", F32(&self.accuracy_m)),
            ("chi2", F32(&self.chi2)),
            ("degrees_of_freedom", F32(&self.degrees_of_freedom)),
        ]
    }

    /// The rows of a row group; `None` if its columns differ.
    fn of(group: &dyn RowGroupReader) -> Result<Option<Self>, ParquetError> {
        let columns = group.metadata().columns();
        let expected = Self::default();
        let expected = expected.columns();
        let has_name = |(column, (name, _)): (&_, &(&str, _))| -> bool {
            let column: &parquet::file::metadata::ColumnChunkMetaData = column;
            column.column_path().parts() == [*name]
        };
        if columns.len() != expected.len() || !columns.iter().zip(&expected).all(has_name) {
            return Ok(None);
        }
        let small = |k| -> Result<Vec<u8>, ParquetError> {
            Ok(cells::<Int32Type>(group, k)?
                .into_iter()
                .map(|one| one as u8)
                .collect())
        };
        let single = |k| cells::<FloatType>(group, k);
        Ok(Some(Self {
            cell: cells::<Int32Type>(group, 0)?
                .into_iter()
                .map(i32::cast_unsigned)
                .collect(),
            outcome: small(1)?,
            faults: small(2)?,
            opinion: small(3)?,
            entry_m: single(4)?,
            position_m: single(5)?,
            accuracy_m: single(6)?,
            chi2: single(7)?,
            degrees_of_freedom: single(8)?,
        }))
    }

    /// Appends the rows of another set.
    pub fn append(&mut self, mut other: Self) {
        self.cell.append(&mut other.cell);
        self.outcome.append(&mut other.outcome);
        self.faults.append(&mut other.faults);
        self.opinion.append(&mut other.opinion);
        self.entry_m.append(&mut other.entry_m);
        self.position_m.append(&mut other.position_m);
        self.accuracy_m.append(&mut other.accuracy_m);
        self.chi2.append(&mut other.chi2);
        self.degrees_of_freedom
            .append(&mut other.degrees_of_freedom);
    }

    /// Whether all columns have the same number of rows.
    fn is_whole(&self) -> bool {
        let lengths = [
            self.outcome.len(),
            self.faults.len(),
            self.opinion.len(),
            self.entry_m.len(),
            self.position_m.len(),
            self.accuracy_m.len(),
            self.chi2.len(),
            self.degrees_of_freedom.len(),
        ];
        lengths.iter().all(|length| *length == self.len())
    }

    fn fingerprint(&self) -> String {
        let mut hash = Fingerprint::new();
        for (row, cell) in self.cell.iter().enumerate() {
            let small = [self.outcome[row], self.faults[row], self.opinion[row]];
            hash = hash.and(&cell.to_le_bytes()).and(&small);
            for value in [
                self.entry_m[row],
                self.position_m[row],
                self.accuracy_m[row],
                self.chi2[row],
                self.degrees_of_freedom[row],
            ] {
                hash = hash.and(&value.to_bits().to_le_bytes());
            }
        }
        hash.to_hex()
    }
}

/// Writes a chunk atomically.
///
/// # Errors
/// If it cannot be written, for example on a full disk.
pub fn write_chunk(folder: &Path, origin: &Origin, rows: &Rows) -> Result<PathBuf, StudyError> {
    let text = serde_json::to_string_pretty(origin)
        .map_err(|error| StudyError::Input(error.to_string()))?;
    let bytes = parquet_file(&rows.columns(), &[(ORIGIN, &text)])
        .map_err(|error| StudyError::Input(error.to_string()))?;
    let path = folder.join(origin.part.file_name());
    write_bytes(&path, &bytes)?;
    Ok(path)
}

/// Reads a chunk and checks its integrity.
///
/// # Errors
/// If the file is damaged; the message names it.
pub fn read_chunk(path: &Path) -> Result<(Origin, Rows), StudyError> {
    let fail = |message: &str| StudyError::Input(format!("{}: {message}", path.display()));
    let file = File::open(path).map_err(|error| fail(&format!("cannot be read ({error})")))?;
    let read = read_damaged(|| read_columns(file)).ok_or_else(|| fail("the file is damaged"))?;
    let (text, rows) = read.map_err(|error| fail(&format!("the file is damaged ({error})")))?;
    let text =
        text.ok_or_else(|| fail("does not state to which study it belongs, expected a chunk"))?;
    let origin: Origin = serde_json::from_str(&text)
        .map_err(|_| fail("does not state to which study it belongs, expected a chunk"))?;
    let rows = rows.filter(Rows::is_whole);
    let rows = rows.ok_or_else(|| fail("found unexpected columns, expected those of a chunk"))?;
    if rows.fingerprint() != origin.content {
        return Err(fail(
            "the file is damaged: its columns differ from what was written",
        ));
    }
    if rows.len() as u64 != origin.range[1].saturating_sub(origin.range[0]) {
        return Err(fail(
            "the number of calibrations differs from the stated range",
        ));
    }
    Ok((origin, rows))
}

/// The origin stored in a file, and its rows if it has the columns of a chunk.
fn read_columns(file: File) -> Result<(Option<String>, Option<Rows>), ParquetError> {
    let reader = SerializedFileReader::new(file)?;
    let about = reader.metadata().file_metadata().key_value_metadata();
    let origin = about
        .into_iter()
        .flatten()
        .find(|about| about.key == ORIGIN);
    let origin = origin.and_then(|about| about.value.clone());
    let mut rows = Rows::default();
    for number in 0..reader.num_row_groups() {
        let group = reader.get_row_group(number)?;
        let Some(more) = Rows::of(group.as_ref())? else {
            return Ok((origin, None));
        };
        rows.append(more);
    }
    Ok((origin, Some(rows)))
}

/// The cells of a column.
fn cells<T: DataType>(
    group: &dyn RowGroupReader,
    column: usize,
) -> Result<Vec<T::T>, ParquetError> {
    if group.metadata().column(column).column_type() != T::get_physical_type() {
        return Err(ParquetError::General("a column of another type".to_owned()));
    }
    let mut reader = get_typed_column_reader::<T>(group.get_column_reader(column)?);
    let mut cells = Vec::new();
    while reader.read_records(1 << 16, None, None, &mut cells)?.0 > 0 {}
    Ok(cells)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_make_the_whole() {
        for (all, of) in [(100, 7), (3, 5), (u64::MAX / 2, 3)] {
            let ranges: Vec<[u64; 2]> = (1..=of)
                .map(|number| ChunkNumber { number, of }.range(all))
                .collect();
            assert_eq!((ranges[0][0], ranges[of as usize - 1][1]), (0, all));
            assert!(ranges.windows(2).all(|pair| pair[0][1] == pair[1][0]));
        }
    }

    #[test]
    fn strange_parts_are_refused() {
        assert_eq!(
            ChunkNumber::parse("3/7"),
            Ok(ChunkNumber { number: 3, of: 7 })
        );
        for text in ["0/7", "8/7", "3", "a/b", "1/0", "-1/3", ""] {
            let message = ChunkNumber::parse(text).expect_err(text);
            assert!(
                message.starts_with(&format!("found {text}, expected")),
                "{message}"
            );
        }
        assert_eq!(
            ChunkNumber { number: 3, of: 120 }.file_name(),
            "chunk-003-of-120.parquet"
        );
    }
}

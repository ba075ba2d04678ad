//! A chunk: the calibrations of a part of a study as columns of one file, with what they belong to.
//!
//! The file is a NumPy archive, `numpy.load("chunk-3-of-7.npz")`: one row for each calibration.

use std::fs;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use tautline_session::{Fingerprint, write_bytes};

use crate::calibration::{Calibration, Outcome};
use crate::npz::{self, Column};
use crate::plan::StudyPlan;
use crate::{StudyError, VERSION};

/// A part of a study: number `number` of `of`, from 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Part {
    /// Which one, from 1.
    pub number: u64,
    /// Of how many.
    pub of: u64,
}

impl Part {
    /// Reads `3/7`.
    ///
    /// # Errors
    /// What was found and what was expected.
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

    /// Its first calibration and the one after its last, of `all`; no part is larger than another by more than one.
    #[must_use]
    pub fn range(self, all: u64) -> [u64; 2] {
        let before =
            |number: u64| (u128::from(all) * u128::from(number) / u128::from(self.of)) as u64;
        [before(self.number - 1), before(self.number)]
    }

    /// Its file.
    #[must_use]
    pub fn file_name(self) -> String {
        let digits = self.of.to_string().len();
        format!("chunk-{:0digits$}-of-{}.npz", self.number, self.of)
    }
}

/// What a chunk belongs to.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Origin {
    /// Fingerprint of the plan.
    pub study: String,
    /// Version of the program.
    pub version: String,
    /// Seed of the study.
    pub seed: u64,
    /// Which part it is.
    pub part: Part,
    /// Its first calibration and the one after its last.
    pub range: [u64; 2],
    /// Fingerprint of its columns.
    pub content: String,
}

impl Origin {
    /// Of a part of a plan with this fingerprint, which this program has done.
    #[must_use]
    pub fn of((plan, fingerprint): (&StudyPlan, &str), part: Part, rows: &Rows) -> Self {
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

/// Text in a chunk that says what it belongs to.
const ORIGIN: &str = "origin.json";

/// The columns of calibrations.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Rows {
    /// Cell of each.
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

    /// Whether there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.cell.is_empty()
    }

    /// Whether a calibration converged.
    #[must_use]
    pub fn converged(&self, row: usize) -> bool {
        self.outcome[row] == Outcome::Converged as u8
    }

    fn columns(&self) -> [(&'static str, Column); 9] {
        [
            ("cell", Column::U32(self.cell.clone())),
            ("outcome", Column::U8(self.outcome.clone())),
            ("faults", Column::U8(self.faults.clone())),
            ("opinion", Column::U8(self.opinion.clone())),
            ("entry_m", Column::F32(self.entry_m.clone())),
            ("position_m", Column::F32(self.position_m.clone())),
            ("accuracy_m", Column::F32(self.accuracy_m.clone())),
            ("chi2", Column::F32(self.chi2.clone())),
            (
                "degrees_of_freedom",
                Column::F32(self.degrees_of_freedom.clone()),
            ),
        ]
    }

    /// Rows of columns; `None` if they are others or of different lengths.
    fn of(columns: Vec<(String, Column)>) -> Option<Self> {
        let mut rows = Self::default();
        for (name, column) in columns {
            match (name.as_str(), column) {
                ("cell", Column::U32(values)) => rows.cell = values,
                ("outcome", Column::U8(values)) => rows.outcome = values,
                ("faults", Column::U8(values)) => rows.faults = values,
                ("opinion", Column::U8(values)) => rows.opinion = values,
                ("entry_m", Column::F32(values)) => rows.entry_m = values,
                ("position_m", Column::F32(values)) => rows.position_m = values,
                ("accuracy_m", Column::F32(values)) => rows.accuracy_m = values,
                ("chi2", Column::F32(values)) => rows.chi2 = values,
                ("degrees_of_freedom", Column::F32(values)) => rows.degrees_of_freedom = values,
                _ => return None,
            }
        }
        let is_whole = rows
            .columns()
            .iter()
            .all(|(_, column)| column.len() == rows.len());
        is_whole.then_some(rows)
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

/// Writes a chunk, completely or not at all.
///
/// # Errors
/// If it cannot be written, as on a full disk.
pub fn write_chunk(folder: &Path, origin: &Origin, rows: &Rows) -> Result<PathBuf, StudyError> {
    let text = serde_json::to_string_pretty(origin)
        .map_err(|error| StudyError::Input(error.to_string()))?;
    let bytes = npz::write((ORIGIN, &text), &rows.columns()).map_err(StudyError::Input)?;
    let path = folder.join(origin.part.file_name());
    write_bytes(&path, &bytes)?;
    Ok(path)
}

/// Reads a chunk and checks that it is whole.
///
/// # Errors
/// One sentence that names the file, if it is damaged.
pub fn read_chunk(path: &Path) -> Result<(Origin, Rows), StudyError> {
    let fail = |message: &str| StudyError::Input(format!("{}: {message}", path.display()));
    let bytes = fs::read(path).map_err(|error| fail(&format!("cannot be read ({error})")))?;
    let (text, columns) = npz::read(&bytes, ORIGIN).map_err(|message| fail(&message))?;
    let origin: Origin = serde_json::from_str(&text)
        .map_err(|_| fail("does not say what study it belongs to, expected a chunk"))?;
    let rows =
        Rows::of(columns).ok_or_else(|| fail("found other columns, expected those of a chunk"))?;
    if rows.fingerprint() != origin.content {
        return Err(fail(
            "the file is damaged: its columns are not those that were written",
        ));
    }
    if rows.len() as u64 != origin.range[1].saturating_sub(origin.range[0]) {
        return Err(fail("found another number of calibrations than it says"));
    }
    Ok((origin, rows))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_make_the_whole() {
        for (all, of) in [(100, 7), (3, 5), (u64::MAX / 2, 3)] {
            let ranges: Vec<[u64; 2]> = (1..=of)
                .map(|number| Part { number, of }.range(all))
                .collect();
            assert_eq!((ranges[0][0], ranges[of as usize - 1][1]), (0, all));
            assert!(ranges.windows(2).all(|pair| pair[0][1] == pair[1][0]));
        }
    }

    #[test]
    fn strange_parts_are_refused() {
        assert_eq!(Part::parse("3/7"), Ok(Part { number: 3, of: 7 }));
        for text in ["0/7", "8/7", "3", "a/b", "1/0", "-1/3", ""] {
            let message = Part::parse(text).expect_err(text);
            assert!(
                message.starts_with(&format!("found {text}, expected")),
                "{message}"
            );
        }
        assert_eq!(
            Part { number: 3, of: 120 }.file_name(),
            "chunk-003-of-120.npz"
        );
    }
}

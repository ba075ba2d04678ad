//! The merged result of a study: for each cell the predicted and the simulated errors.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tautline_core::statistics::chi_square_survival;
use tautline_session::VersionedFile;

use crate::VERSION;
use crate::calibration::{Opinion, Outcome};
use crate::chunk::Rows;
use crate::plan::{PlannedCell, StudyPlan};
use crate::statistics::ErrorStatistics;

/// Relative difference between theory and simulation from which a cell is marked.
pub const MARKED: f64 = 0.05;
/// Normal quantile of 95 % intervals.
const Z95: f64 = 1.959_964;

/// The result of a study.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct StudyResult {
    /// Fingerprint of the plan.
    pub study: String,
    /// Version of the program.
    pub program_version: String,
    /// Simulated calibrations.
    pub calibrations: u64,
    /// The cells, in the order of the plan.
    pub cells: Vec<CellResult>,
}

/// The result of a cell.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CellResult {
    /// The planned cell with its predicted errors.
    #[serde(flatten)]
    pub planned: PlannedCell,
    /// Simulated errors; null if the cell was not simulated.
    pub simulated: Option<SimulatedErrors>,
}

/// Simulated errors of a cell.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SimulatedErrors {
    /// Number of calibrations.
    pub calibrations: u64,
    /// Number of those that did not converge.
    pub not_converged: u64,
    /// Number of those that could not be simulated because of their faults.
    pub not_simulated: u64,
    /// Error of the entry points in calibrations without faults.
    pub entry: Option<ErrorRange>,
    /// Position error over the workspace in calibrations without faults.
    pub position: Option<ErrorRange>,
    /// Pose accuracy AP (ISO 9283) in calibrations without faults.
    pub accuracy: Option<ErrorRange>,
    /// Position error over the workspace in calibrations with a fault.
    pub position_with_fault: Option<ErrorRange>,
    /// Ratio of simulated to expected position error, with its 95 % interval.
    pub over_expected: Option<[f64; 3]>,
    /// Whether this ratio differs from 1 by more than 5 %.
    pub is_marked: bool,
    /// Calibrations without a fault, and how many of them the global test rejected: false alarms.
    pub without_fault: Share,
    /// Calibrations with a fault, and how many of them the global test rejected: detections.
    pub with_fault: Share,
    /// Verdicts of the diagnosis.
    pub doctor: Opinions,
}

/// Distribution of an error over many calibrations.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ErrorRange {
    /// Root mean square (m).
    pub rms_m: f64,
    /// Relative standard error of the root mean square.
    pub relative_standard_error: f64,
    /// Quantiles of 5, 50 and 95 % (m).
    pub quantiles_m: [f64; 3],
}

/// A share, `count` of `of`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
pub struct Share {
    /// Total number.
    pub of: u64,
    /// Number counted.
    pub count: u64,
}

/// Numbers of verdicts of the diagnosis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
pub struct Opinions {
    /// No fault named although there is one.
    pub missed: u64,
    /// No fault named, and there is none.
    pub rightly_silent: u64,
    /// All faults named and no other.
    pub right: u64,
    /// A fault named that is not present.
    pub wrong: u64,
    /// Faults detected, but only some of them named, or none.
    pub partly: u64,
}

impl VersionedFile for StudyResult {
    const FORMAT: &'static str = "tautline-study-result";
    const VERSION: u32 = 1;
    const MAX_BYTES: u64 = 1 << 30;
}

/// Accumulated statistics of all cells.
pub struct Tallies {
    cells: Vec<Tally>,
    simulated: Vec<usize>,
}

#[derive(Default)]
struct Tally {
    calibrations: u64,
    not_converged: u64,
    not_simulated: u64,
    entry: ErrorStatistics,
    position: ErrorStatistics,
    accuracy: ErrorStatistics,
    position_with_fault: ErrorStatistics,
    without_fault: Share,
    with_fault: Share,
    doctor: Opinions,
}

impl Tallies {
    /// Empty statistics for the cells of a plan.
    #[must_use]
    pub fn new(plan: &StudyPlan) -> Self {
        Self {
            cells: plan.cells.iter().map(|_| Tally::default()).collect(),
            simulated: plan.simulated(),
        }
    }

    /// Adds the calibrations of a chunk, the first of which is number `from` of the study.
    ///
    /// # Errors
    /// If the cell of a calibration contradicts its number.
    pub fn add(&mut self, plan: &StudyPlan, from: u64, rows: &Rows) -> Result<(), String> {
        let simulated = &self.simulated;
        let each = plan.study.simulation.calibrations;
        let alpha = plan.study.simulation.alpha;
        for row in 0..rows.len() {
            let place = simulated.get(((from + row as u64) / each) as usize);
            let cell = rows.cell[row] as usize;
            if place != Some(&cell) {
                return Err(format!(
                    "found calibration {} in cell {cell}, to which it does not belong",
                    from + row as u64
                ));
            }
            self.cells[cell].add(rows, row, alpha);
        }
        Ok(())
    }

    /// The result of the study with the given fingerprint.
    #[must_use]
    pub fn result(self, plan: &StudyPlan, fingerprint: String) -> StudyResult {
        let cells = self.cells.into_iter().zip(&plan.cells);
        StudyResult {
            study: fingerprint,
            program_version: VERSION.to_owned(),
            calibrations: plan.calibrations(),
            cells: cells
                .map(|(tally, planned)| CellResult {
                    simulated: (tally.calibrations > 0).then(|| tally.errors(planned)),
                    planned: planned.clone(),
                })
                .collect(),
        }
    }
}

impl Tally {
    fn add(&mut self, rows: &Rows, row: usize, alpha: f64) {
        self.calibrations += 1;
        let has_fault = rows.faults[row] != 0;
        if !rows.converged(row) {
            match rows.outcome[row] == Outcome::NotSimulated as u8 {
                true => self.not_simulated += 1,
                false => self.not_converged += 1,
            }
            return;
        }
        let [entry, position, accuracy] = [
            rows.entry_m[row],
            rows.position_m[row],
            rows.accuracy_m[row],
        ]
        .map(f64::from);
        let add = |to: &mut ErrorStatistics, error: f64| {
            if !error.is_nan() {
                to.add(error);
            }
        };
        if has_fault {
            add(&mut self.position_with_fault, position);
        } else {
            add(&mut self.entry, entry);
            add(&mut self.position, position);
            add(&mut self.accuracy, accuracy);
        }
        let p = chi_square_survival(
            f64::from(rows.chi2[row]),
            f64::from(rows.degrees_of_freedom[row]),
        );
        let share = if has_fault {
            &mut self.with_fault
        } else {
            &mut self.without_fault
        };
        share.of += 1;
        share.count += u64::from(p.is_some_and(|p| p < alpha));
        let doctor = &mut self.doctor;
        let counted = match rows.opinion[row] {
            verdict if verdict == Opinion::Silent as u8 && has_fault => &mut doctor.missed,
            verdict if verdict == Opinion::Silent as u8 => &mut doctor.rightly_silent,
            verdict if verdict == Opinion::Right as u8 => &mut doctor.right,
            verdict if verdict == Opinion::Wrong as u8 => &mut doctor.wrong,
            verdict if verdict == Opinion::Partly as u8 => &mut doctor.partly,
            _ => return,
        };
        *counted += 1;
    }

    fn errors(self, planned: &PlannedCell) -> SimulatedErrors {
        let position = range(&self.position);
        let over_expected = position
            .zip(planned.expected.position_m)
            .map(|(found, expected)| {
                let ratio = found.rms_m / expected;
                let half = Z95 * found.relative_standard_error * ratio;
                [ratio, ratio - half, ratio + half]
            });
        SimulatedErrors {
            calibrations: self.calibrations,
            not_converged: self.not_converged,
            not_simulated: self.not_simulated,
            entry: range(&self.entry),
            position,
            accuracy: range(&self.accuracy),
            position_with_fault: range(&self.position_with_fault),
            is_marked: over_expected.is_some_and(|[ratio, ..]| (ratio - 1.0).abs() > MARKED),
            over_expected,
            without_fault: self.without_fault,
            with_fault: self.with_fault,
            doctor: self.doctor,
        }
    }
}

fn range(of: &ErrorStatistics) -> Option<ErrorRange> {
    Some(ErrorRange {
        rms_m: of.rms_m()?,
        relative_standard_error: of.relative_standard_error().unwrap_or(0.0),
        quantiles_m: [
            of.quantile_m(0.05)?,
            of.quantile_m(0.5)?,
            of.quantile_m(0.95)?,
        ],
    })
}

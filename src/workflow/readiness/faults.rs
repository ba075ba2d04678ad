//! Readings that cannot be right.

use tautline_core::measurement::Dataset;
use tautline_core::robot::Cable;
use tautline_import::{Mistake, Quantity, QuantityKind as Kind, TableCheck, check_table};
use tautline_session::PoseLines;

use crate::wording::count;

/// Smallest number of rows: each gives one length of a cable, and a pulley has three coordinates; the row at home, from
/// which revolutions count, gives none, but there the pose is known.
const FEWEST_ROWS: usize = 3;
/// Negative tension that noise does not explain, in standard deviations of its sensor.
const PUSHING: f64 = 5.0;
/// Length below which a nonzero encoder reading at home is noise (m).
const HOME_LENGTH_M: f64 = 5e-3;

/// A reading that cannot be right.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ReadingFault {
    /// Row of the measurements.
    pub row: usize,
    /// Name of the column in `poses.csv`.
    pub column: String,
    /// What was found and what was expected.
    pub message: String,
    /// Whether the fault makes every identification invalid. A reading may also be impossible because of an error of the
    /// instrument, which a diagnosis can name.
    pub prevents_identification: bool,
}

impl ReadingFault {
    /// One sentence with the place: in the table if the readings come from one, else the pose.
    #[must_use]
    pub fn sentence(&self, dataset: &Dataset, table: Option<&PoseLines>) -> String {
        match table {
            Some(table) => {
                let error = table.error(self.row, &self.column, &self.message);
                format!("{error}.")
            }
            None => {
                let pose = format!("Pose {}", dataset.measurements.labels[self.row]);
                match self.column == label_column() {
                    true => format!("{pose}: {}.", self.message),
                    false => format!("{pose}, {}: {}.", self.column, self.message),
                }
            }
        }
    }
}

/// All faults of this kind, by the rules of the check, the gravest first.
#[must_use]
pub fn reading_faults(dataset: &Dataset) -> Vec<ReadingFault> {
    let data = &dataset.measurements;
    let mut faults: Vec<ReadingFault> = no_lengths(dataset).into_iter().collect();
    if faults.is_empty() {
        faults.extend(few_rows(dataset));
    }
    faults.extend(turned_at_home(dataset));
    faults.extend(pushing_cables(dataset));
    faults.extend(in_other_frame(dataset, &check_table(data, &dataset.robot)));
    faults
}

fn label_column() -> String {
    let kind = Kind::Label;
    Quantity { kind, index: 0 }.column()
}

/// Columns of lengths without a number at any pose besides home.
pub(super) fn no_lengths(dataset: &Dataset) -> Option<ReadingFault> {
    let data = &dataset.measurements;
    let (grid, kind, what) = match data.revolutions.is_empty() {
        false => (&data.revolutions, Kind::Revolutions, "revolutions"),
        true => (&data.length_m, Kind::Length, "lengths"),
    };
    // Revolutions at home are the zero from which the others count, not lengths.
    let home = data.home_row().filter(|_| kind == Kind::Revolutions);
    let mut rows = (0..grid.rows()).filter(|row| Some(*row) != home);
    let first = rows.next()?;
    let is_empty = |row: usize| grid.row(row).iter().all(|value| value.is_nan());
    if !is_empty(first) || !rows.all(is_empty) {
        return None;
    }
    let column = |cable: usize| Quantity { kind, index: cable }.column();
    let last = column(dataset.robot.cable_count().saturating_sub(1));
    Some(ReadingFault {
        row: first,
        column: column(0),
        message: format!(
            "found no number from here to the last row of {last}, so no row has a length, expected {what}"
        ),
        prevents_identification: true,
    })
}

/// Fewer rows than could determine the robot.
pub(super) fn few_rows(dataset: &Dataset) -> Option<ReadingFault> {
    let data = &dataset.measurements;
    let row = data.len().checked_sub(1)?;
    (data.len() < FEWEST_ROWS).then(|| ReadingFault {
        row,
        column: label_column(),
        message: format!(
            "found {} in all, which cannot determine the robot, expected at least {FEWEST_ROWS}, and 20 or more for an accurate result",
            count(data.len(), "row")
        ),
        prevents_identification: true,
    })
}

/// Encoders that do not read zero at the home pose, from which revolutions count.
pub(super) fn turned_at_home(dataset: &Dataset) -> Vec<ReadingFault> {
    let data = &dataset.measurements;
    let Some(row) = data.home_row().filter(|_| !data.revolutions.is_empty()) else {
        return Vec::new();
    };
    let fault = |(cable, (value, described)): (usize, (&f64, &Cable))| {
        let length_m = value * described.winch.cable_per_revolution_m();
        (length_m.abs() > HOME_LENGTH_M).then(|| ReadingFault {
            row,
            column: Quantity {
                kind: Kind::Revolutions,
                index: cable,
            }
            .column(),
            message: format!(
                "found {value} revolutions of {} at home, expected 0, as revolutions count from there",
                described.name
            ),
            prevents_identification: true,
        })
    };
    let readings = data.revolutions.row(row).iter().zip(&dataset.robot.cables);
    readings.enumerate().filter_map(fault).collect()
}

/// The first negative tension of every cable whose noise does not explain it.
pub(super) fn pushing_cables(dataset: &Dataset) -> Vec<ReadingFault> {
    let data = &dataset.measurements;
    if data.force_n.is_empty() {
        return Vec::new();
    }
    let fault = |(cable, described): (usize, &Cable)| {
        let sensor = described.force_sensor?;
        let tension_n = |row: usize| sensor.tension_n(data.force_n.get(row, cable));
        let mut rows =
            (0..data.len()).filter(|row| tension_n(*row) < -PUSHING * sensor.tension_sd_n);
        let row = rows.next()?;
        let more = match rows.count() {
            0 => String::new(),
            more => format!(" (and {more} more in this column)"),
        };
        Some(ReadingFault {
            row,
            column: Quantity {
                kind: Kind::Force,
                index: cable,
            }
            .column(),
            message: format!(
                "found {} N{more}, a negative tension of {}, expected a positive one, as a cable cannot push",
                data.force_n.get(row, cable),
                described.name
            ),
            prevents_identification: false,
        })
    };
    let cables = dataset.robot.cables.iter().enumerate();
    cables.filter_map(fault).collect()
}

/// Measured poses that are in another frame than the robot's: the effect of its frame is far smaller.
pub(super) fn in_other_frame(dataset: &Dataset, found: &TableCheck) -> Option<ReadingFault> {
    let mut suggestions = found.suggestions.iter();
    let other = suggestions.find(|one| one.mistake == Mistake::OtherFrame)?;
    let data = &dataset.measurements;
    let row = (0..data.len()).find(|row| data.tracked_position_at(*row).is_some())?;
    Some(ReadingFault {
        row,
        column: Quantity {
            kind: Kind::Tracked,
            index: 0,
        }
        .column(),
        message: format!(
            "{}, expected poses in the frame of the robot: import with \"instrument\": {{}} in the recipe, or --apply-suggestions",
            other.sentence
        ),
        prevents_identification: false,
    })
}

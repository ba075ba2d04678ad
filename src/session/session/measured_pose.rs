//! One measured pose, as it arrives from the instruments.

use tautline_core::geometry::Pose;
use tautline_core::measurement::{Grid, Measurements};
use tautline_core::robot::FieldError;

use super::{MeasurementTable, Session, below, fail};

/// The readings at one pose; quantities and units are those of `poses.csv`.
///
/// Quantities per cable are empty where the quantity was not measured, and NaN at a cable where
/// it was not.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct MeasuredPose {
    /// Label of the pose, 0 for the home pose.
    pub label: i64,
    /// Label of the pose that was measured again and that this one counts instead of.
    pub repeats: Option<i64>,
    /// Time of measurement (s).
    pub time_s: Option<f64>,
    /// Temperature (degrees Celsius).
    pub temperature_c: Option<f64>,
    /// Commanded pose.
    pub commanded: Option<Pose>,
    /// Motor revolutions since home, per cable.
    pub revolutions: Vec<f64>,
    /// Absolute lengths instead of revolutions, per cable (m).
    pub length_m: Vec<f64>,
    /// Raw force readings, per cable (N).
    pub force_n: Vec<f64>,
    /// Laser distance (m).
    pub laser_m: Option<f64>,
    /// Swivel angles of the pulleys, per cable (rad).
    pub swivel_rad: Vec<f64>,
    /// Roll, pitch, yaw of the inclinometer (rad).
    pub inclination_rad: Option<[f64; 3]>,
    /// Platform position by the external instrument (m).
    pub tracked_position_m: Option<[f64; 3]>,
    /// Platform orientation by the external instrument, quaternion w first.
    pub tracked_orientation_wxyz: Option<[f64; 4]>,
    /// Standard deviation of the tracked position (m), where it differs from the robot's.
    pub tracked_position_sd_m: Option<[f64; 3]>,
}

impl MeasuredPose {
    /// Its readings as a table of one row, still unchecked.
    pub(crate) fn table(&self) -> MeasurementTable {
        MeasurementTable::of(&Measurements {
            labels: vec![self.label],
            time_s: self.time_s.into_iter().collect(),
            temperature_c: self.temperature_c.into_iter().collect(),
            commanded: self.commanded.map(Some).into_iter().collect(),
            revolutions: one_row(&self.revolutions),
            length_m: one_row(&self.length_m),
            force_n: one_row(&self.force_n),
            laser_m: self.laser_m.into_iter().collect(),
            swivel_rad: one_row(&self.swivel_rad),
            inclination_rad: self.inclination_rad.into_iter().collect(),
            tracked_position_m: self.tracked_position_m.into_iter().collect(),
            tracked_orientation_wxyz: self.tracked_orientation_wxyz.into_iter().collect(),
            tracked_position_sd_m: self.tracked_position_sd_m.into_iter().collect(),
            ..Measurements::default()
        })
    }
}

fn one_row(values: &[f64]) -> Grid {
    let mut grid = Grid::new(values.len());
    grid.push_row(values);
    grid
}

impl Session {
    /// The label for a pose that is measured again: greater than all that are measured or planned.
    #[must_use]
    pub fn next_label(&self) -> i64 {
        let planned = self.plan.iter().map(|pose| pose.label);
        let labels = self.measurements.labels.iter().copied().chain(planned);
        labels.fold(0, i64::max).saturating_add(1)
    }

    /// Adds one measured pose as the last row. A pose that it repeats is left out from now on.
    ///
    /// Truth of simulated data is dropped where the new row has none, because it is known for all
    /// poses or for none.
    ///
    /// # Errors
    /// If the label is measured already, the readings are not those of this robot or make no
    /// sense, or the pose that it repeats is not there or is the home pose; nothing changes then.
    pub fn append_pose(&mut self, pose: &MeasuredPose) -> Result<(), FieldError> {
        self.append_table(pose.table(), pose.repeats)
    }

    /// Adds the poses that another state of the same session has and this one has not; gives their labels.
    ///
    /// # Errors
    /// If such a pose does not fit; those before it are added.
    pub fn append_missing(&mut self, other: &Self) -> Result<Vec<i64>, FieldError> {
        let mut added = Vec::new();
        for (row, label) in other.measurements.labels.iter().enumerate() {
            if !self.measurements.labels.contains(label) {
                let table = MeasurementTable::of(&other.measurements.select(&[row]));
                self.append_table(table, None)?;
                added.push(*label);
            }
        }
        Ok(added)
    }

    pub(crate) fn append_table(
        &mut self,
        table: MeasurementTable,
        repeats: Option<i64>,
    ) -> Result<(), FieldError> {
        let rows = self.measurements.len();
        let row = table
            .into_row(&self.robot, rows)
            .map_err(|error| below("/measurements", error))?;
        for label in &row.labels {
            if let Some(earlier) = self.measurements.labels.iter().position(|l| l == label) {
                let message = format!(
                    "found {label} again (value {earlier}), expected a pose that is not measured yet"
                );
                return fail(format!("/measurements/pose/{rows}"), message);
            }
        }
        self.check_lengths_alike(&row)?;
        if let Some(repeated) = repeats {
            self.exclude(repeated)?;
        }
        for label in &row.labels {
            self.include(*label);
        }
        append(&mut self.measurements, row);
        Ok(())
    }

    /// All poses have revolutions or all have absolute lengths.
    fn check_lengths_alike(&self, row: &Measurements) -> Result<(), FieldError> {
        let m = &self.measurements;
        let (column, expected) = if !m.revolutions.is_empty() && !row.length_m.is_empty() {
            ("length_1_m", "revolutions")
        } else if !m.length_m.is_empty() && !row.revolutions.is_empty() {
            ("rev_1", "absolute lengths")
        } else {
            return Ok(());
        };
        let message = format!("found a reading, expected {expected} as at the poses before");
        fail(format!("/measurements/columns/{column}"), message)
    }
}

/// Appends rows; a column that only one side has is filled with "not measured".
fn append(to: &mut Measurements, rows: Measurements) {
    let (before, added) = (to.len(), rows.len());
    join(&mut to.labels, rows.labels, before, added, &0);
    join(&mut to.time_s, rows.time_s, before, added, &f64::NAN);
    let temperature_c = &mut to.temperature_c;
    join(temperature_c, rows.temperature_c, before, added, &f64::NAN);
    join(&mut to.commanded, rows.commanded, before, added, &None);
    join_grid(&mut to.revolutions, &rows.revolutions, before, added);
    join_grid(&mut to.length_m, &rows.length_m, before, added);
    join_grid(&mut to.force_n, &rows.force_n, before, added);
    join(&mut to.laser_m, rows.laser_m, before, added, &f64::NAN);
    join_grid(&mut to.swivel_rad, &rows.swivel_rad, before, added);
    let missing = [f64::NAN; 3];
    let inclination = &mut to.inclination_rad;
    join(inclination, rows.inclination_rad, before, added, &missing);
    let position = &mut to.tracked_position_m;
    join(position, rows.tracked_position_m, before, added, &missing);
    let orientation = &mut to.tracked_orientation_wxyz;
    let rows_orientation = rows.tracked_orientation_wxyz;
    join(orientation, rows_orientation, before, added, &[f64::NAN; 4]);
    let sd = &mut to.tracked_position_sd_m;
    join(sd, rows.tracked_position_sd_m, before, added, &missing);
    if rows.truth.poses.is_empty() || (to.truth.poses.is_empty() && before > 0) {
        to.truth.poses.clear();
    } else {
        to.truth.poses.extend(rows.truth.poses);
    }
    let truth = &mut to.truth.tension_n;
    join_grid(truth, &rows.truth.tension_n, before, added);
    for (_, cells) in &mut to.other {
        cells.extend(vec![String::new(); added]);
    }
}

fn join<T: Clone>(to: &mut Vec<T>, rows: Vec<T>, before: usize, added: usize, missing: &T) {
    if to.is_empty() && rows.is_empty() {
        return;
    }
    to.resize(before, missing.clone());
    to.extend(rows);
    to.resize(before + added, missing.clone());
}

fn join_grid(to: &mut Grid, rows: &Grid, before: usize, added: usize) {
    if rows.is_empty() && to.is_empty() {
        return;
    }
    if to.is_empty() {
        *to = Grid::missing(before, rows.columns());
    }
    let missing = vec![f64::NAN; to.columns()];
    for row in 0..added {
        to.push_row(if rows.is_empty() {
            &missing
        } else {
            rows.row(row)
        });
    }
}

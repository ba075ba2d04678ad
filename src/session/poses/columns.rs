//! Measurements as named columns, the common form of `poses.csv` and session files.

use tautline_core::geometry::Pose;
use tautline_core::measurement::{Grid, Measurements};
use tautline_core::robot::Robot;

use super::column::{Group, PerCable, PoseColumn};

/// Measurements by column; all columns have the length of `labels`.
#[derive(Debug, Default)]
pub(crate) struct Columns {
    /// Labels of the poses.
    pub labels: Vec<i64>,
    /// Group labels; empty if there is no such column.
    pub groups: Vec<String>,
    /// Numeric columns; NaN means not measured.
    pub numbers: Vec<(PoseColumn, Vec<f64>)>,
    /// Unknown columns.
    pub other: Vec<(String, Vec<String>)>,
}

/// An error in a column, with its row.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Fault {
    /// Row from 0; `None` for the table as a whole.
    pub row: Option<usize>,
    /// Name of the column.
    pub column: String,
    /// Message: what was found, and what was expected.
    pub message: String,
    /// The earlier row that it contradicts.
    pub earlier_row: Option<usize>,
}

impl Fault {
    pub fn new(row: Option<usize>, column: impl Into<String>, message: impl Into<String>) -> Self {
        Self {
            row,
            column: column.into(),
            message: message.into(),
            earlier_row: None,
        }
    }

    pub fn at<T>(
        row: usize,
        column: impl Into<String>,
        message: impl Into<String>,
    ) -> Result<T, Self> {
        Err(Self::new(Some(row), column, message))
    }
}

impl Columns {
    /// The values of a column, if present.
    pub fn get(&self, column: PoseColumn) -> Option<&[f64]> {
        let mut columns = self.numbers.iter();
        columns
            .find(|(known, _)| *known == column)
            .map(|(_, values)| values.as_slice())
    }

    /// Removes a column and returns its values.
    pub fn take(&mut self, column: PoseColumn) -> Option<Vec<f64>> {
        let place = self
            .numbers
            .iter()
            .position(|(known, _)| *known == column)?;
        Some(self.numbers.swap_remove(place).1)
    }

    /// Whether at least one column of a group is present.
    pub fn has(&self, group: Group) -> bool {
        (0..group.names().len()).any(|k| self.get(PoseColumn::Component(group, k)).is_some())
    }

    fn has_per_cable(&self, quantity: PerCable) -> bool {
        let mut columns = self.numbers.iter();
        columns
            .any(|(column, _)| matches!(column, PoseColumn::Cable(known, _) if *known == quantity))
    }

    /// Checks that the columns are those of this robot.
    pub fn check_header(&self, robot: &Robot) -> Result<(), Fault> {
        let fail = |column: String, message: String| Err(Fault::new(None, column, message));
        let cables = robot.cable_count();
        for (column, _) in &self.numbers {
            if let PoseColumn::Cable(_, number) = column
                && !(1..=cables).contains(number)
            {
                let message = format!("found cable {number}, expected 1 to {cables}");
                return fail(column.name(), message);
            }
        }
        for quantity in PerCable::ALL {
            let is_missing =
                |number: &usize| self.get(PoseColumn::Cable(quantity, *number)).is_none();
            if let Some(number) = (1..=cables).find(is_missing)
                && self.has_per_cable(quantity)
            {
                let message = format!("missing, expected one column for each of {cables} cables");
                return fail(quantity.name(number), message);
            }
        }
        self.check_lengths(robot)?;
        self.check_complete_poses(robot)
    }

    /// Checks that the numbers can be stored: NaN is an empty cell, but infinities are invalid.
    pub fn check_finite(&self) -> Result<(), Fault> {
        for (column, values) in &self.numbers {
            if let Some(row) = values.iter().position(|value| value.is_infinite()) {
                let message = format!("found {}, expected a finite number", values[row]);
                return Fault::at(row, column.name(), message);
            }
        }
        Ok(())
    }

    fn check_lengths(&self, robot: &Robot) -> Result<(), Fault> {
        let kinds = [PerCable::Revolutions, PerCable::Change, PerCable::Length];
        let found: Vec<PerCable> = kinds
            .into_iter()
            .filter(|kind| self.has_per_cable(*kind))
            .collect();
        let (column, message) = match found[..] {
            [] => (
                PerCable::Revolutions.name(1),
                "missing, expected rev_1, change_1_m or length_1_m".to_owned(),
            ),
            [PerCable::Length] => return Ok(()),
            [kind] if robot.home.is_none() => (
                kind.name(1),
                "found readings since home but the robot has no home, expected length_1_m"
                    .to_owned(),
            ),
            [_] => return Ok(()),
            [first, second, ..] => (
                second.name(1),
                format!("found beside {}, expected one or the other", first.name(1)),
            ),
        };
        Err(Fault::new(None, column, message))
    }

    /// Turns lengths of cable paid out since home into the revolutions that pay them out.
    pub fn count_revolutions(&mut self, robot: &Robot) {
        for (column, values) in &mut self.numbers {
            if let PoseColumn::Cable(PerCable::Change, number) = *column {
                let winch = &robot.cables[number - 1].winch;
                let per_revolution_m = winch.cable_per_revolution_m();
                values
                    .iter_mut()
                    .for_each(|value| *value /= per_revolution_m);
                *column = PoseColumn::Cable(PerCable::Revolutions, number);
            }
        }
    }

    /// Checks that commanded and true poses have all their columns; a platform needs none of a coordinate in which it cannot move.
    fn check_complete_poses(&self, robot: &Robot) -> Result<(), Fault> {
        let rotates = robot.platform.turns();
        for group in [Group::Commanded, Group::TruePose, Group::Tracked] {
            let is_free = |k: usize| robot.platform.free.iter().any(|c| c.index() == k);
            let missing = |k: &usize| {
                self.get(PoseColumn::Component(group, *k)).is_none() && (*k >= 3 || is_free(*k))
            };
            let position_is_partial = group != Group::Tracked && (0..3).any(|k| missing(&k));
            let no_quaternion = (3..7).all(|k| missing(&k));
            let needs_quaternion = rotates && group != Group::Tracked;
            let range = match (position_is_partial, no_quaternion && !needs_quaternion) {
                (true, true) => 0..3,
                (true, false) => 0..7,
                (false, true) => continue,
                (false, false) => 3..7,
            };
            if let Some(k) = range.clone().find(missing)
                && self.has(group)
            {
                let message = "missing, expected beside the other columns of the pose";
                return Err(Fault::new(None, group.names()[k], message));
            }
        }
        Ok(())
    }

    /// The columns of measurements, without quantities that were never measured.
    pub fn of(measurements: &Measurements) -> Self {
        let m = measurements;
        let mut columns = Self {
            labels: m.labels.clone(),
            groups: m.groups.clone(),
            numbers: Vec::new(),
            other: m.other.clone(),
        };
        columns.add(PoseColumn::Time, &m.time_s);
        columns.add(PoseColumn::Temperature, &m.temperature_c);
        let commanded: Vec<[f64; 7]> = m.commanded.iter().map(pose_row).collect();
        columns.add_group(Group::Commanded, 0, &commanded);
        columns.add_grid(PerCable::Revolutions, &m.revolutions);
        columns.add_grid(PerCable::Length, &m.length_m);
        columns.add_grid(PerCable::Force, &m.force_n);
        columns.add(PoseColumn::Laser, &m.laser_m);
        columns.add_grid(PerCable::Swivel, &m.swivel_rad);
        columns.add_group(Group::Inclination, 0, &m.inclination_rad);
        columns.add_group(Group::Tracked, 0, &m.tracked_position_m);
        columns.add_group(Group::Tracked, 3, &m.tracked_orientation_wxyz);
        columns.add_group(Group::TrackedSd, 0, &m.tracked_position_sd_m);
        let truth: Vec<[f64; 7]> = m.truth.poses.iter().map(|p| pose_row(&Some(*p))).collect();
        columns.add_group(Group::TruePose, 0, &truth);
        columns.add_grid(PerCable::TrueTension, &m.truth.tension_n);
        columns
    }

    fn add(&mut self, column: PoseColumn, values: &[f64]) {
        if !values.is_empty() {
            self.numbers.push((column, values.to_vec()));
        }
    }

    fn add_group<const N: usize>(&mut self, group: Group, first: usize, rows: &[[f64; N]]) {
        for k in 0..N {
            let values: Vec<f64> = rows.iter().map(|row| row[k]).collect();
            self.add(PoseColumn::Component(group, first + k), &values);
        }
    }

    fn add_grid(&mut self, quantity: PerCable, grid: &Grid) {
        for cable in 0..grid.columns() {
            let values: Vec<f64> = (0..grid.rows()).map(|row| grid.get(row, cable)).collect();
            self.add(PoseColumn::Cable(quantity, cable + 1), &values);
        }
    }
}

/// Position and quaternion unchanged, so that they read back bit by bit.
fn pose_row(pose: &Option<Pose>) -> [f64; 7] {
    pose.as_ref().map_or([f64::NAN; 7], |pose| {
        let (p, q) = (pose.position, pose.orientation.quaternion());
        [p.x, p.y, p.z, q.w, q.i, q.j, q.k]
    })
}

//! Measurements in columns; NaN marks a missing reading, an empty column a quantity that was never measured.

use super::{DistanceReading, Rates};
use crate::geometry::{Pose, Vec3};
use crate::robot::Robot;

/// A robot together with the measurements taken on it.
#[derive(Debug, Clone, PartialEq)]
pub struct Dataset {
    /// The robot, nominal or as a model.
    pub robot: Robot,
    /// One row per measured pose.
    pub measurements: Measurements,
}

/// One value per pose and cable, row-major; NaN where the quantity was not measured.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Grid {
    columns: usize,
    values: Vec<f64>,
}

impl Grid {
    /// A grid without rows for `columns` cables.
    #[must_use]
    pub fn new(columns: usize) -> Self {
        Self {
            columns,
            values: Vec::new(),
        }
    }

    /// A grid of one pose; empty if there are no values.
    #[must_use]
    pub fn of_row(values: Vec<f64>) -> Self {
        Self {
            columns: values.len(),
            values,
        }
    }

    /// A grid of `rows` poses and `columns` cables without any measured value.
    #[must_use]
    pub fn missing(rows: usize, columns: usize) -> Self {
        Self {
            columns,
            values: vec![f64::NAN; rows * columns],
        }
    }

    /// Appends the values of one pose.
    ///
    /// # Panics
    /// If the number of values differs from the number of columns.
    pub fn push_row(&mut self, row: &[f64]) {
        assert_eq!(row.len(), self.columns, "one value per cable");
        self.values.extend_from_slice(row);
    }

    /// Whether the quantity was never measured.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// Number of cables.
    #[must_use]
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Number of poses.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.values.len().checked_div(self.columns).unwrap_or(0)
    }

    /// Values of one pose; empty if the quantity was never measured.
    #[must_use]
    pub fn row(&self, pose: usize) -> &[f64] {
        if self.is_empty() {
            return &[];
        }
        &self.values[pose * self.columns..(pose + 1) * self.columns]
    }

    /// The value at a pose and cable, NaN if not measured.
    #[must_use]
    pub fn get(&self, pose: usize, cable: usize) -> f64 {
        self.row(pose).get(cable).copied().unwrap_or(f64::NAN)
    }

    /// Sets the value at a pose and cable.
    pub fn set(&mut self, pose: usize, cable: usize, value: f64) {
        self.values[pose * self.columns + cable] = value;
    }
}

/// All measurements, one entry per pose in each column that is not empty.
///
/// Column meanings and units are those of `poses.csv`.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Measurements {
    /// Labels of the poses; 0 is the home pose if the robot has one.
    pub labels: Vec<i64>,
    /// Time of measurement (s).
    pub time_s: Vec<f64>,
    /// Temperature (degrees Celsius).
    pub temperature_c: Vec<f64>,
    /// Group labels: poses with the same label were read in one standstill (or one run) and share slow errors; an empty
    /// label means no group.
    pub groups: Vec<String>,
    /// Commanded pose, where given.
    pub commanded: Vec<Option<Pose>>,
    /// Motor revolutions since home, positive pays cable out.
    pub revolutions: Grid,
    /// Absolute cable length from entry point to platform anchor (m), instead of revolutions.
    pub length_m: Grid,
    /// Raw force sensor reading (N).
    pub force_n: Grid,
    /// Laser distance (m).
    pub laser_m: Vec<f64>,
    /// Swivel angle of the pulleys (rad).
    pub swivel_rad: Grid,
    /// Roll, pitch, yaw of the inclinometer (rad).
    pub inclination_rad: Vec<[f64; 3]>,
    /// Platform position measured by the external instrument (m).
    pub tracked_position_m: Vec<[f64; 3]>,
    /// Platform orientation measured by the external instrument, quaternion w first.
    pub tracked_orientation_wxyz: Vec<[f64; 4]>,
    /// Standard deviation of the tracked position (m), where it differs from the robot's.
    pub tracked_position_sd_m: Vec<[f64; 3]>,
    /// Sign of the travel of each cable before each row, +1 where it was paid out, if rows in between were left out; otherwise
    /// empty, as it follows from the readings.
    pub travel: Grid,
    /// Distances between poses.
    pub distances: Vec<DistanceReading>,
    /// True values of simulated data.
    pub truth: Truth,
    /// Time derivatives of the readings, for samples of a recording in motion; `None` for poses at rest.
    pub rates: Option<Rates>,
    /// Unknown columns: name and cells, kept when the data are written.
    pub other: Vec<(String, Vec<String>)>,
}

/// True values behind simulated data; never used by identification or diagnosis.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Truth {
    /// True poses.
    pub poses: Vec<Pose>,
    /// True tensions (N).
    pub tension_n: Grid,
}

impl Measurements {
    /// Number of rows, the home row included.
    #[must_use]
    pub fn len(&self) -> usize {
        self.labels.len()
    }

    /// Whether there are no rows.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.labels.is_empty()
    }

    /// Row of the home pose (label 0).
    #[must_use]
    pub fn home_row(&self) -> Option<usize> {
        self.labels.iter().position(|label| *label == 0)
    }

    /// Sign of the travel of a cable before a row, counted from `home`: +1 where it was paid out, -1 where it was reeled in, 0 for
    /// no change; `None` where it is unknown.
    #[must_use]
    pub fn travel_before(&self, home: Option<usize>, (row, cable): (usize, usize)) -> Option<f64> {
        if !self.travel.is_empty() {
            return Some(self.travel.get(row, cable)).filter(|sign| !sign.is_nan());
        }
        let reading = |row: usize| {
            if self.revolutions.is_empty() {
                self.length_m.get(row, cable)
            } else if home == Some(row) {
                0.0
            } else {
                self.revolutions.get(row, cable)
            }
        };
        let change = reading(row) - reading(row.checked_sub(1)?);
        (!change.is_nan()).then(|| if change == 0.0 { 0.0 } else { change.signum() })
    }

    /// Evenly chosen rows, at most `most` besides the home row, with the travel before each.
    pub(super) fn thinned(&self, home: Option<usize>, most: usize) -> Option<Self> {
        let others: Vec<usize> = (0..self.len()).filter(|row| Some(*row) != home).collect();
        if others.len() <= most {
            return None;
        }
        let kept = (0..most).map(|k| others[k * others.len() / most]);
        let mut rows: Vec<usize> = home.into_iter().chain(kept).collect();
        rows.sort_unstable();
        let mut thinned = self.select(&rows);
        let cables = self.revolutions.columns().max(self.length_m.columns());
        thinned.travel = Grid::missing(rows.len(), cables);
        for (to, row) in rows.iter().enumerate() {
            for cable in 0..cables {
                let sign = self.travel_before(home, (*row, cable));
                thinned.travel.set(to, cable, sign.unwrap_or(f64::NAN));
            }
        }
        Some(thinned)
    }

    /// Laser distance at a pose (m), NaN if not measured.
    #[must_use]
    pub fn laser_at(&self, pose: usize) -> f64 {
        self.laser_m.get(pose).copied().unwrap_or(f64::NAN)
    }

    /// Tracked position at a pose (m), if all three coordinates were measured.
    #[must_use]
    pub fn tracked_position_at(&self, pose: usize) -> Option<Vec3> {
        let position = Vec3::from(*self.tracked_position_m.get(pose)?);
        position.iter().all(|v| v.is_finite()).then_some(position)
    }

    /// Orientation measured by the external instrument at a row, if any.
    #[must_use]
    pub fn tracked_orientation_at(&self, pose: usize) -> Option<nalgebra::UnitQuaternion<f64>> {
        let q = *self.tracked_orientation_wxyz.get(pose)?;
        let is_read = q.iter().all(|v| v.is_finite());
        is_read.then(|| Pose::from_parts([0.0; 3], q).orientation)
    }

    /// The distances between rows that have a number, with these numbers.
    pub(super) fn distances_of(
        &self,
        number: impl Fn(usize) -> Option<usize>,
    ) -> Vec<DistanceReading> {
        let distances = self.distances.iter();
        distances
            .filter_map(|one| one.renumbered(&number))
            .collect()
    }

    /// The measurements of the given rows, in the given order.
    #[must_use]
    pub fn select(&self, rows: &[usize]) -> Self {
        fn pick<T: Clone>(column: &[T], rows: &[usize]) -> Vec<T> {
            if column.is_empty() {
                return Vec::new();
            }
            rows.iter().map(|row| column[*row].clone()).collect()
        }
        let pick_grid = |grid: &Grid| {
            let mut picked = Grid::new(grid.columns());
            if !grid.is_empty() {
                rows.iter().for_each(|row| picked.push_row(grid.row(*row)));
            }
            picked
        };
        Self {
            labels: pick(&self.labels, rows),
            time_s: pick(&self.time_s, rows),
            temperature_c: pick(&self.temperature_c, rows),
            groups: pick(&self.groups, rows),
            commanded: pick(&self.commanded, rows),
            revolutions: pick_grid(&self.revolutions),
            length_m: pick_grid(&self.length_m),
            force_n: pick_grid(&self.force_n),
            laser_m: pick(&self.laser_m, rows),
            swivel_rad: pick_grid(&self.swivel_rad),
            inclination_rad: pick(&self.inclination_rad, rows),
            tracked_position_m: pick(&self.tracked_position_m, rows),
            tracked_orientation_wxyz: pick(&self.tracked_orientation_wxyz, rows),
            tracked_position_sd_m: pick(&self.tracked_position_sd_m, rows),
            travel: pick_grid(&self.travel),
            distances: self.distances_of(|row| rows.iter().position(|own| *own == row)),
            truth: Truth {
                poses: pick(&self.truth.poses, rows),
                tension_n: pick_grid(&self.truth.tension_n),
            },
            rates: self.rates.as_ref().map(|rates| Rates {
                length: [0, 1].map(|k| pick_grid(&rates.length[k])),
                force: [0, 1].map(|k| pick_grid(&rates.force[k])),
                laser: pick(&rates.laser, rows),
                tracked: pick(&rates.tracked, rows),
                sampling: rates.sampling.clone(),
            }),
            other: self
                .other
                .iter()
                .map(|(name, cells)| (name.clone(), pick(cells, rows)))
                .collect(),
        }
    }

    /// Appends the rows of `other`. A quantity that only one of the two has is missing in the rows of the other one;
    /// true poses are kept only if all rows have one, and the rates of a recording never.
    pub fn append(&mut self, other: Self) {
        self.rates = None;
        self.travel = Grid::default();
        let (before, added) = (self.len(), other.len());
        let join = Join { before, added };
        let listed = self.distances.len();
        for mut distance in other.distances_of(|row| Some(before + row)) {
            distance.number += listed;
            self.distances.push(distance);
        }
        if other.truth.poses.is_empty() || (self.truth.poses.is_empty() && before > 0) {
            self.truth.poses.clear();
        } else {
            self.truth.poses.extend(other.truth.poses);
        }
        let (tension, more) = (&mut self.truth.tension_n, &other.truth.tension_n);
        join.grids(tension, more);
        self.labels.extend(other.labels);
        join.columns(&mut self.time_s, other.time_s, &f64::NAN);
        join.columns(&mut self.temperature_c, other.temperature_c, &f64::NAN);
        join.columns(&mut self.groups, other.groups, &String::new());
        join.columns(&mut self.commanded, other.commanded, &None);
        join.grids(&mut self.revolutions, &other.revolutions);
        join.grids(&mut self.length_m, &other.length_m);
        join.grids(&mut self.force_n, &other.force_n);
        join.columns(&mut self.laser_m, other.laser_m, &f64::NAN);
        join.grids(&mut self.swivel_rad, &other.swivel_rad);
        let missing = [f64::NAN; 3];
        join.columns(&mut self.inclination_rad, other.inclination_rad, &missing);
        let position = &mut self.tracked_position_m;
        join.columns(position, other.tracked_position_m, &missing);
        let (orientation, more) = (
            &mut self.tracked_orientation_wxyz,
            other.tracked_orientation_wxyz,
        );
        join.columns(orientation, more, &[f64::NAN; 4]);
        let sd = &mut self.tracked_position_sd_m;
        join.columns(sd, other.tracked_position_sd_m, &missing);
        for (name, cells) in other.other {
            match self.other.iter_mut().find(|(known, _)| *known == name) {
                Some((_, known)) => known.extend(cells),
                None => self
                    .other
                    .push((name, [vec![String::new(); before], cells].concat())),
            }
        }
        for (_, cells) in &mut self.other {
            cells.resize(before + added, String::new());
        }
    }

    /// Removes the readings of the kinds that `data` does not contain.
    pub(crate) fn leave_out_unread(&mut self, data: &Self) {
        fn column<T>(own: &mut Vec<T>, read: &[T]) {
            if read.is_empty() {
                own.clear();
            }
        }
        for (grid, read) in [
            (&mut self.force_n, &data.force_n),
            (&mut self.swivel_rad, &data.swivel_rad),
        ] {
            if read.is_empty() {
                *grid = Grid::default();
            }
        }
        column(&mut self.time_s, &data.time_s);
        column(&mut self.temperature_c, &data.temperature_c);
        column(&mut self.laser_m, &data.laser_m);
        column(&mut self.inclination_rad, &data.inclination_rad);
        column(&mut self.tracked_position_m, &data.tracked_position_m);
        let turned = &data.tracked_orientation_wxyz;
        column(&mut self.tracked_orientation_wxyz, turned);
    }
}

/// Row counts of two tables, the second of which is appended to the first.
struct Join {
    before: usize,
    added: usize,
}

impl Join {
    fn columns<T: Clone>(&self, to: &mut Vec<T>, more: Vec<T>, missing: &T) {
        if !to.is_empty() || !more.is_empty() {
            to.resize(self.before, missing.clone());
            to.extend(more);
            to.resize(self.before + self.added, missing.clone());
        }
    }

    fn grids(&self, to: &mut Grid, more: &Grid) {
        match (to.is_empty(), more.is_empty()) {
            (true, true) => return,
            (true, false) => *to = Grid::missing(self.before, more.columns()),
            (false, _) => {}
        }
        let nothing = vec![f64::NAN; to.columns()];
        for row in 0..self.added {
            match more.is_empty() {
                true => to.push_row(&nothing),
                false => to.push_row(more.row(row)),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thinned_rows_know_the_travel_before_them() {
        let mut data = Measurements::default();
        for (row, revolutions) in [0.0, 3.0, 1.0, 2.0, 2.0, 0.5, f64::NAN].iter().enumerate() {
            data.labels.push(row as i64);
            data.revolutions = match row {
                0 => Grid::of_row(vec![*revolutions]),
                _ => {
                    data.revolutions.push_row(&[*revolutions]);
                    data.revolutions
                }
            };
        }
        assert_eq!(data.thinned(Some(0), 6), None);
        let thinned = data.thinned(Some(0), 3).unwrap();
        assert_eq!(thinned.labels, [0, 1, 3, 5]);
        let travel = |data: &Measurements, row| data.travel_before(Some(0), (row, 0));
        for (row, label) in thinned.labels.iter().enumerate().skip(1) {
            assert_eq!(travel(&thinned, row), travel(&data, *label as usize));
        }
        // From 1 to 2 revolutions, while the row kept before has 3.
        assert_eq!(travel(&thinned, 2), Some(1.0));
        assert_eq!(travel(&data, 6), None);
    }
}

//! Averaging of the rows read in one standstill.
//!
//! An error common to a standstill does not average out: with an error of standard deviation `s_g` that `n` rows share
//! and noise `s` of each row, their mean has the variance `s_g^2 + s^2 / n` and carries all their information about the robot.
//! Taken as independent readings they would claim `s^2 / n`.

use std::borrow::Cow;
use std::ops::Range;

use super::{Grid, Measurements};
use crate::robot::Robot;

/// Change of a reading, in its standard deviations, beyond which the robot moved or the reading jumped.
const STILL: f64 = 10.0;

impl Measurements {
    /// Rows of each standstill, in order: consecutive rows with the same group label, or the same commanded pose and
    /// no label, whose lengths and laser readings agree. The home row stands alone.
    #[must_use]
    pub fn standstills(&self, robot: &Robot) -> Vec<Range<usize>> {
        let home = robot.home.and(self.home_row());
        let mut found: Vec<Range<usize>> = Vec::new();
        for row in 0..self.len() {
            match found.last_mut() {
                Some(last)
                    if Some(row) != home
                        && Some(last.start) != home
                        && self.is_one_standstill(robot, last.start, row) =>
                {
                    last.end = row + 1;
                }
                _ => found.push(row..row + 1),
            }
        }
        found
    }

    fn is_one_standstill(&self, robot: &Robot, one: usize, other: usize) -> bool {
        let label = |row: usize| self.groups.get(row).map_or("", String::as_str);
        let commanded = |row: usize| self.commanded.get(row).copied().flatten();
        let same_label = label(one) == label(other);
        let same_pose = commanded(one) == commanded(other);
        let is_known = !label(one).is_empty() || commanded(one).is_some();
        let still =
            |a: f64, b: f64, sd: f64| a.is_nan() || b.is_nan() || (a - b).abs() <= STILL * sd;
        let grids = |grid: &Grid, sd: &dyn Fn(usize) -> f64| {
            let mut cables = 0..robot.cable_count();
            cables.all(|cable| still(grid.get(one, cable), grid.get(other, cable), sd(cable)))
        };
        let length_sd = |cable: usize| robot.cables[cable].winch.length_sd_m;
        let per_revolution = |cable: usize| robot.cables[cable].winch.cable_per_revolution_m();
        let laser_sd = robot
            .laser
            .as_ref()
            .map_or(f64::INFINITY, |laser| laser.sd_m);
        is_known
            && same_label
            && same_pose
            && grids(&self.length_m, &length_sd)
            && grids(&self.revolutions, &|cable| {
                length_sd(cable) / per_revolution(cable).abs()
            })
            && still(self.laser_at(one), self.laser_at(other), laser_sd)
    }

    /// One row for each standstill, the mean of its rows, and the largest number of rows merged into one; borrows the
    /// measurements unchanged if no two rows belong to one standstill.
    #[must_use]
    pub fn standstills_averaged(&self, robot: &Robot) -> (Cow<'_, Self>, usize) {
        let standstills = self.standstills(robot);
        let most = standstills.iter().map(Range::len).max().unwrap_or(1);
        if most < 2 {
            return (Cow::Borrowed(self), 1);
        }
        let first: Vec<usize> = standstills.iter().map(|rows| rows.start).collect();
        let mut averaged = self.select(&first);
        averaged.distances = self.distances_of(|row| {
            let mut all = standstills.iter();
            all.position(|rows| rows.contains(&row))
        });
        for (row, rows) in standstills
            .iter()
            .enumerate()
            .filter(|(_, rows)| rows.len() > 1)
        {
            self.average(rows, &mut averaged, row);
        }
        (Cow::Owned(averaged), most)
    }

    /// Writes the means of some rows into one row of `to`.
    fn average(&self, rows: &Range<usize>, to: &mut Self, row: usize) {
        let grids = [
            (&self.revolutions, &mut to.revolutions),
            (&self.length_m, &mut to.length_m),
            (&self.force_n, &mut to.force_n),
            (&self.swivel_rad, &mut to.swivel_rad),
        ];
        for (from, to) in grids.into_iter().filter(|(from, _)| !from.is_empty()) {
            for cable in 0..from.columns() {
                to.set(row, cable, mean(rows.clone().map(|k| from.get(k, cable))));
            }
        }
        let columns = [
            (&self.time_s, &mut to.time_s),
            (&self.temperature_c, &mut to.temperature_c),
            (&self.laser_m, &mut to.laser_m),
        ];
        for (from, to) in columns.into_iter().filter(|(from, _)| !from.is_empty()) {
            to[row] = mean(from[rows.clone()].iter().copied());
        }
        let triples = [
            (&self.inclination_rad, &mut to.inclination_rad),
            (&self.tracked_position_m, &mut to.tracked_position_m),
        ];
        for (from, to) in triples.into_iter().filter(|(from, _)| !from.is_empty()) {
            to[row] = means(&from[rows.clone()]);
        }
        let turned = &self.tracked_orientation_wxyz;
        if !turned.is_empty() {
            // q and -q are the same orientation; consecutive rows differ by noise only.
            let first = turned[rows.start];
            let alike = turned[rows.clone()].iter().map(|q| {
                let dot: f64 = q.iter().zip(first).map(|(a, b)| a * b).sum();
                q.map(|v| if dot < 0.0 { -v } else { v })
            });
            let sum = means(&alike.collect::<Vec<_>>());
            let norm = sum.iter().map(|v| v * v).sum::<f64>().sqrt();
            to.tracked_orientation_wxyz[row] = sum.map(|v| v / norm);
        }
    }
}

/// Mean of the values present; NaN if there is none.
fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let known: Vec<f64> = values.filter(|v| v.is_finite()).collect();
    known.iter().sum::<f64>() / known.len() as f64
}

fn means<const N: usize>(rows: &[[f64; N]]) -> [f64; N] {
    std::array::from_fn(|k| mean(rows.iter().map(|row| row[k])))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::presets;

    fn data(revolutions: &[f64], groups: &[&str]) -> Measurements {
        let mut grid = Grid::new(8);
        revolutions.iter().for_each(|r| grid.push_row(&[*r; 8]));
        Measurements {
            labels: (0..revolutions.len() as i64).collect(),
            groups: groups.iter().map(|g| (*g).to_owned()).collect(),
            revolutions: grid,
            ..Measurements::default()
        }
    }

    #[test]
    fn rows_of_a_standstill_become_their_mean() {
        let robot = presets::find("mini").unwrap().robot;
        let sd = robot.cables[0].winch.length_sd_m / robot.cables[0].winch.cable_per_revolution_m();
        let data = data(
            &[0.0, 1.0, 1.0 + sd, f64::NAN, 2.0, 2.0],
            &["", "a", "a", "a", "b", ""],
        );
        assert_eq!(data.standstills(&robot), [0..1, 1..4, 4..5, 5..6]);
        let (averaged, most) = data.standstills_averaged(&robot);
        assert_eq!((averaged.len(), most), (4, 3));
        assert_eq!(averaged.labels, [0, 1, 4, 5]);
        // Two of the three rows have a reading.
        assert!((averaged.revolutions.get(1, 3) - (1.0 + 0.5 * sd)).abs() < 1e-15);
        assert_eq!(averaged.revolutions.get(2, 0).to_bits(), 2.0_f64.to_bits());
    }

    #[test]
    fn what_moved_or_jumped_is_no_standstill() {
        let robot = presets::find("mini").unwrap().robot;
        let run = data(&[0.0, 1.0, 1.5, 2.0], &["run", "run", "run", "run"]);
        assert_eq!(run.standstills(&robot).len(), 4);
        let (same, most) = run.standstills_averaged(&robot);
        assert!(matches!(same, Cow::Borrowed(_)) && most == 1);
    }

    #[test]
    fn orientations_of_either_sign_have_a_mean() {
        let robot = presets::find("mini").unwrap().robot;
        let mut data = data(&[0.0, 1.0, 1.0], &["", "a", "a"]);
        let (sin, cos) = 0.01_f64.sin_cos();
        data.tracked_orientation_wxyz = vec![
            [1.0, 0.0, 0.0, 0.0],
            [cos, sin, 0.0, 0.0],
            [-cos, sin, 0.0, 0.0],
        ];
        let (averaged, _) = data.standstills_averaged(&robot);
        let mean = averaged.tracked_orientation_wxyz[1];
        assert!(
            (mean[0] - 1.0).abs() < 1e-12 && mean[1].abs() < 1e-12,
            "{mean:?}"
        );
    }
}

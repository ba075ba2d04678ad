//! Conversion of named columns to checked measurements.

use std::collections::HashMap;

use nalgebra::{Quaternion, Unit, UnitQuaternion};
use tautline_core::geometry::{Pose, Vec3};
use tautline_core::measurement::{Grid, Measurements, Truth};
use tautline_core::robot::Robot;

use super::column::{Group, PerCable, PoseColumn};
use super::columns::{Columns, Fault};
use super::plausible::check_plausible;
use crate::table::quaternion_fault;

impl Columns {
    /// The measurements, checked against the robot. Data from tables, session files, the recovery journal and
    /// the instruments all pass through here.
    pub fn into_measurements(mut self, robot: &Robot) -> Result<Measurements, Fault> {
        if self.labels.is_empty() {
            return Ok(Measurements::default());
        }
        self.check_header(robot)?;
        self.check_finite()?;
        self.count_revolutions(robot);
        let measurements = assemble(self, robot)?;
        check_plausible(&measurements, robot)?;
        Ok(measurements)
    }
}

/// Columns are removed as they are used, so that at most one quantity is in memory twice.
fn assemble(mut columns: Columns, robot: &Robot) -> Result<Measurements, Fault> {
    check_labels(&columns.labels)?;
    let cables = robot.cable_count();
    let columns = &mut columns;
    let tracked_orientation_wxyz = group::<4>(columns, Group::Tracked, 3);
    for (row, quaternion) in tracked_orientation_wxyz.iter().enumerate() {
        check_quaternion(row, quaternion, Group::Tracked)?;
    }
    let truth = poses(columns, Group::TruePose, robot)?;
    if let Some(row) = truth.iter().position(Option::is_none) {
        return Fault::at(row, "true_x_m", "found an empty cell, expected a number");
    }
    Ok(Measurements {
        truth: Truth {
            poses: truth.into_iter().flatten().collect(),
            tension_n: grid(columns, PerCable::TrueTension, cables),
        },
        time_s: columns.take(PoseColumn::Time).unwrap_or_default(),
        temperature_c: columns.take(PoseColumn::Temperature).unwrap_or_default(),
        commanded: poses(columns, Group::Commanded, robot)?,
        revolutions: grid(columns, PerCable::Revolutions, cables),
        length_m: grid(columns, PerCable::Length, cables),
        force_n: grid(columns, PerCable::Force, cables),
        laser_m: columns.take(PoseColumn::Laser).unwrap_or_default(),
        swivel_rad: grid(columns, PerCable::Swivel, cables),
        inclination_rad: group(columns, Group::Inclination, 0),
        tracked_position_m: group(columns, Group::Tracked, 0),
        tracked_orientation_wxyz,
        tracked_position_sd_m: group(columns, Group::TrackedSd, 0),
        labels: std::mem::take(&mut columns.labels),
        groups: std::mem::take(&mut columns.groups),
        other: std::mem::take(&mut columns.other),
        ..Measurements::default()
    })
}

fn check_labels(labels: &[i64]) -> Result<(), Fault> {
    // Strictly rising labels, the usual case, need no table of earlier labels.
    if labels.is_sorted_by(|before, after| before < after) {
        return Ok(());
    }
    let mut rows = HashMap::with_capacity(labels.len());
    for (row, label) in labels.iter().enumerate() {
        if let Some(earlier) = rows.insert(*label, row) {
            let message = format!("found {label} again, expected each label once");
            return Err(Fault {
                earlier_row: Some(earlier),
                ..Fault::new(Some(row), super::LABEL, message)
            });
        }
    }
    Ok(())
}

/// Components `first..first + N` of a group by row; empty if none of them was measured.
fn group<const N: usize>(columns: &mut Columns, group: Group, first: usize) -> Vec<[f64; N]> {
    let parts: [Option<Vec<f64>>; N] =
        std::array::from_fn(|k| columns.take(PoseColumn::Component(group, first + k)));
    if parts.iter().all(Option::is_none) {
        return Vec::new();
    }
    let value = |part: &Option<Vec<f64>>, row: usize| part.as_ref().map_or(f64::NAN, |v| v[row]);
    (0..columns.labels.len())
        .map(|row| parts.each_ref().map(|part| value(part, row)))
        .collect()
}

fn grid(columns: &mut Columns, quantity: PerCable, cables: usize) -> Grid {
    let parts: Option<Vec<Vec<f64>>> = (1..=cables)
        .map(|number| columns.take(PoseColumn::Cable(quantity, number)))
        .collect();
    let Some(parts) = parts else {
        return Grid::default();
    };
    // Row by row, the memory layout of a grid.
    let mut grid = Grid::missing(columns.labels.len(), cables);
    for row in 0..columns.labels.len() {
        for (cable, values) in parts.iter().enumerate() {
            grid.set(row, cable, values[row]);
        }
    }
    grid
}

/// Poses of a group; `None` for a row without numbers.
fn poses(columns: &mut Columns, of: Group, robot: &Robot) -> Result<Vec<Option<Pose>>, Fault> {
    let mut positions = group::<3>(columns, of, 0);
    let held = held_position(robot);
    for position in positions
        .iter_mut()
        .filter(|position| measured(*position) > 0)
    {
        for (value, held) in position.iter_mut().zip(held) {
            *value = held.filter(|_| value.is_nan()).unwrap_or(*value);
        }
    }
    let mut quaternions = group::<4>(columns, of, 3);
    if quaternions.is_empty() {
        // A platform that does not rotate keeps its orientation at home.
        let home = robot
            .home
            .map_or([1.0, 0.0, 0.0, 0.0], |home| home.orientation_wxyz);
        quaternions = positions
            .iter()
            .map(|p| {
                if measured(p) == 0 {
                    [f64::NAN; 4]
                } else {
                    home
                }
            })
            .collect();
    }
    let rows = positions.iter().zip(&quaternions).enumerate();
    rows.map(|(row, (position, quaternion))| pose(row, position, quaternion, of))
        .collect()
}

/// The coordinates of a position in which the platform cannot move: those at home, else those of the plane of the pulleys.
fn held_position(robot: &Robot) -> [Option<f64>; 3] {
    let of_pulleys = |k: usize| {
        let all = robot
            .cables
            .iter()
            .map(|cable| cable.pulley.entry_point_m[k]);
        all.sum::<f64>() / robot.cable_count() as f64
    };
    std::array::from_fn(|k| {
        let is_free = robot.platform.free.iter().any(|c| c.index() == k);
        let at_home = robot.home.map(|home| home.position_m[k]);
        (!is_free).then(|| at_home.unwrap_or_else(|| of_pulleys(k)))
    })
}

/// Number of cells that are not empty.
fn measured(values: &[f64]) -> usize {
    values.iter().filter(|value| !value.is_nan()).count()
}

fn check_quaternion(row: usize, wxyz: &[f64; 4], of: Group) -> Result<(), Fault> {
    match quaternion_fault(wxyz) {
        Some((k, message)) => Fault::at(row, of.names()[3 + k], message),
        None => Ok(()),
    }
}

fn pose(
    row: usize,
    position: &[f64; 3],
    quaternion: &[f64; 4],
    of: Group,
) -> Result<Option<Pose>, Fault> {
    let mut cells = position.iter().chain(quaternion);
    match (measured(position), measured(quaternion)) {
        (0, 0) => Ok(None),
        (3, 4) => {
            check_quaternion(row, quaternion, of)?;
            Ok(Some(Pose {
                position: Vec3::from(*position),
                orientation: orientation(quaternion),
            }))
        }
        _ => {
            let empty = cells.position(|value| value.is_nan()).unwrap_or_default();
            let message = "found an empty cell, expected the whole pose or no cell of it";
            Fault::at(row, of.names()[empty], message)
        }
    }
}

/// A quaternion that is already normalised stays as it is, to the last bit.
fn orientation(wxyz: &[f64; 4]) -> UnitQuaternion<f64> {
    let [w, x, y, z] = *wxyz;
    let quaternion = Quaternion::new(w, x, y, z);
    if (quaternion.norm_squared() - 1.0).abs() < 1e-14 {
        Unit::new_unchecked(quaternion)
    } else {
        UnitQuaternion::from_quaternion(quaternion)
    }
}

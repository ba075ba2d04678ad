//! Expected readings at the poses.

use std::collections::BTreeMap;

use tautline_core::geometry::{Pose, Vec3};
use tautline_core::kinematics::inverse_kinematics;
use tautline_core::robot::Robot;

use super::{Readings, lengths};
use crate::external::other_frame;
use crate::recipe::{Quantity, QuantityKind as Kind};

/// Expected readings by column, and the poses at which they are computed.
pub(super) struct Expected {
    /// Pose of each row, if known.
    pub poses: Vec<Option<Pose>>,
    /// Whether the poses are computed from the readings of the winches, whose errors they share in part.
    pub from_lengths: bool,
    columns: BTreeMap<Quantity, Vec<f64>>,
}

impl Expected {
    pub fn of(readings: &Readings, robot: &Robot) -> Self {
        let commanded = poses(readings, robot, Kind::Commanded);
        let suffice =
            |poses: &[Option<Pose>]| poses.iter().flatten().count() * 2 >= readings.labels.len();
        let (poses, source) = if suffice(&commanded) {
            (commanded, PoseSource::Commanded)
        } else {
            let measured = poses(readings, robot, Kind::Tracked);
            match from_lengths(readings, robot, suffice(&measured)) {
                Some(computed) => (computed, PoseSource::Lengths),
                None => (measured, PoseSource::Measured),
            }
        };
        let mut expected = Self {
            columns: BTreeMap::new(),
            poses,
            from_lengths: source == PoseSource::Lengths,
        };
        expected.cables(robot);
        expected.instruments(robot, source);
        expected
    }

    /// Expected readings of a column.
    pub fn column(&self, quantity: Quantity) -> Option<&[f64]> {
        self.columns.get(&quantity).map(Vec::as_slice)
    }

    fn set(&mut self, kind: Kind, index: usize, row: usize, value: f64) {
        let rows = self.poses.len();
        let column = self
            .columns
            .entry(Quantity { kind, index })
            .or_insert_with(|| vec![f64::NAN; rows]);
        column[row] = value;
    }

    fn cables(&mut self, robot: &Robot) {
        let home = robot
            .home
            .and_then(|home| inverse_kinematics(robot, &home.pose()).ok());
        for row in 0..self.poses.len() {
            let Some(states) =
                self.poses[row].and_then(|pose| inverse_kinematics(robot, &pose).ok())
            else {
                continue;
            };
            for (index, (state, cable)) in states.iter().zip(&robot.cables).enumerate() {
                let from_home = home.as_ref().map_or(0.0, |home| home[index].length_m);
                let change_m = state.length_m - from_home;
                let turns = change_m / cable.winch.cable_per_revolution_m();
                self.set(Kind::Revolutions, index, row, turns);
                self.set(Kind::Change, index, row, change_m);
                self.set(Kind::Length, index, row, state.length_m);
                if let Some(swivel) = state.swivel_rad {
                    self.set(Kind::Swivel, index, row, swivel);
                }
            }
        }
    }

    fn instruments(&mut self, robot: &Robot, source: PoseSource) {
        for row in 0..self.poses.len() {
            let Some(pose) = self.poses[row] else {
                continue;
            };
            if let Some(laser) = &robot.laser {
                let normal = Vec3::from(laser.target_plane.normal);
                let origin = pose.transform(&laser.origin_m.into());
                let along = normal.dot(&(pose.orientation * Vec3::from(laser.direction)));
                self.set(
                    Kind::Laser,
                    0,
                    row,
                    (laser.target_plane.offset_m - normal.dot(&origin)) / along,
                );
            }
            let turn = pose.orientation.to_rotation_matrix();
            let roll = (-turn[(1, 2)]).atan2(turn[(2, 2)]);
            let yaw = (-turn[(0, 1)]).atan2(turn[(0, 0)]);
            for (index, angle) in [roll, turn[(0, 2)].clamp(-1.0, 1.0).asin(), yaw]
                .into_iter()
                .enumerate()
            {
                self.set(Kind::Inclination, index, row, angle);
            }
            // An instrument is not compared with itself.
            if source != PoseSource::Measured {
                for index in 0..3 {
                    self.set(Kind::Tracked, index, row, pose.position[index]);
                }
            }
        }
    }
}

/// Source of the poses for which readings are predicted.
#[derive(Clone, Copy, PartialEq, Eq)]
enum PoseSource {
    Commanded,
    Measured,
    Lengths,
}

/// Poses computed from the cable lengths if measured poses are missing or in another frame.
fn from_lengths(
    readings: &Readings,
    robot: &Robot,
    is_measured: bool,
) -> Option<Vec<Option<Pose>>> {
    let computed = lengths::poses(readings, robot);
    if !is_measured {
        return computed;
    }
    let computed = computed.or_else(|| lengths::poses_as_read(readings, robot))?;
    let pairs = readings.measured_with(&computed)?;
    other_frame(&pairs, robot.frame_size_m()?).map(|_| computed)
}

/// Poses from a group of columns. The home pose needs no command.
fn poses(readings: &Readings, robot: &Robot, kind: Kind) -> Vec<Option<Pose>> {
    let value = |index: usize, row: usize| {
        readings
            .columns
            .get(&Quantity { kind, index })
            .map_or(f64::NAN, |values| values[row])
    };
    let home = robot.home;
    let upright = home.map_or([1.0, 0.0, 0.0, 0.0], |home| home.orientation_wxyz);
    let rotates = robot.platform.turns();
    let pose = |row: usize| -> Option<Pose> {
        let position = [0, 1, 2].map(|index| value(index, row));
        let turned = [3, 4, 5, 6].map(|index| value(index, row));
        let is_there = |values: &[f64]| values.iter().all(|value| value.is_finite());
        let norm = turned.iter().map(|value| value * value).sum::<f64>().sqrt();
        match (is_there(&position), is_there(&turned) && norm > 0.5) {
            (true, true) => Some(Pose::from_parts(position, turned.map(|value| value / norm))),
            (true, false) if !rotates || kind == Kind::Commanded => {
                Some(Pose::from_parts(position, upright))
            }
            _ if readings.labels[row] == 0 => home.map(|home| home.pose()),
            _ => None,
        }
    };
    (0..readings.labels.len()).map(pose).collect()
}

//! Channels that vary with the cables: they follow the lengths at the commanded poses, or carry the platform there.

use std::f64::consts::TAU;

use nalgebra::DVector;
use tautline_channels::Channel;
use tautline_core::geometry::Pose;
use tautline_core::kinematics::{applied_wrench, inverse_kinematics, structure_matrix};
use tautline_core::robot::Robot;

use super::recognition::since_home;
use crate::check::fit;
use crate::recipe::{Mapping, Quantity, QuantityKind as Kind};

/// Maximum number of rows that are examined.
const MOST_ROWS: usize = 300;
/// Minimum number of rows for a conclusion.
const FEWEST_ROWS: usize = 8;
/// Scatter about the line, relative to that of the values, below which a channel follows a cable: pulleys may be centimetres off.
const FOLLOWS: f64 = 0.25;
/// Relative tolerance within which a slope is a known one.
const SLOPE: f64 = 0.12;
/// Largest squared force that is left over, relative to the squared weight, where tensions carry the platform.
const LEFT_OVER: f64 = 0.25;

/// The commanded poses of a series, and the lengths of the cables there.
pub(super) struct CommandedPoses {
    /// Index of the series among all.
    pub series: usize,
    rows: Vec<usize>,
    poses: Vec<Pose>,
    /// By cable and row (m).
    lengths_m: Vec<Vec<f64>>,
}

impl CommandedPoses {
    /// `None` if no whole pose is commanded.
    pub fn of(mapping: &Mapping<'_>, robot: &Robot) -> Option<Self> {
        let mapped = |index: usize| {
            mapping.quantities.get(&Quantity {
                kind: Kind::Commanded,
                index,
            })
        };
        let position = [mapped(0)?, mapped(1)?, mapped(2)?];
        let rotation = [mapped(3), mapped(4), mapped(5), mapped(6)];
        let rotates = robot.platform.turns();
        if rotates && rotation.iter().any(Option::is_none) {
            return None;
        }
        let series = position[0].series;
        let value = |of: &crate::recipe::Mapped, row: usize| {
            let values = &mapping.series[of.series].channels[of.channel].values;
            of.factor * values.at(row) + of.offset
        };
        let count = mapping.series[series].rows;
        let mut found = Self {
            series,
            rows: Vec::new(),
            poses: Vec::new(),
            lengths_m: vec![Vec::new(); robot.cable_count()],
        };
        for row in (0..count).step_by(count.div_ceil(MOST_ROWS).max(1)) {
            let position_m = position.map(|of| value(of, row));
            let turned = rotation.map(|of| of.map_or(f64::NAN, |of| value(of, row)));
            let turned = if rotates {
                turned
            } else {
                [1.0, 0.0, 0.0, 0.0]
            };
            if position_m.iter().chain(&turned).any(|value| value.is_nan()) {
                continue;
            }
            let pose = Pose::from_parts(position_m, turned);
            let Ok(cables) = inverse_kinematics(robot, &pose) else {
                continue;
            };
            found.rows.push(row);
            found.poses.push(pose);
            for (lengths, cable) in found.lengths_m.iter_mut().zip(&cables) {
                lengths.push(cable.length_m);
            }
        }
        (found.rows.len() >= FEWEST_ROWS).then_some(found)
    }

    /// Kind, unit and sign of channels, one for each cable, that all follow the length of their cable equally.
    pub fn followed_by(
        &self,
        channels: &[&Channel],
        robot: &Robot,
    ) -> Option<(Kind, Option<&'static str>, bool)> {
        let mut slopes = Vec::new();
        for (lengths, channel) in self.lengths_m.iter().zip(channels) {
            let values: Vec<f64> = self
                .rows
                .iter()
                .map(|row| channel.values.at(*row))
                .collect();
            let line = fit(lengths, &values).filter(|line| line.scatter < FOLLOWS)?;
            slopes.push(line.slope);
        }
        let mean = slopes.iter().sum::<f64>() / slopes.len() as f64;
        let is_near = |slope: f64, known: f64| (slope / known - 1.0).abs() < SLOPE;
        if !slopes.iter().all(|slope| is_near(*slope, mean)) {
            return None;
        }
        let per_m = 1.0 / robot.cables[0].winch.cable_per_revolution_m();
        let known = [
            (1.0, Kind::Length, None),
            (1e3, Kind::Length, Some("mm")),
            (per_m, Kind::Revolutions, None),
            (360.0 * per_m, Kind::Revolutions, Some("deg")),
            (TAU * per_m, Kind::Revolutions, Some("rad")),
        ];
        let found = known
            .into_iter()
            .find(|(slope, ..)| is_near(mean.abs(), *slope));
        found.map(|(_, kind, unit)| (since_home(kind, channels), unit, mean < 0.0))
    }

    /// Whether channels are cable forces that balance the weight of the platform.
    pub fn are_carried_by(&self, channels: &[&Channel], robot: &Robot) -> bool {
        let sensors: Option<Vec<_>> = robot
            .cables
            .iter()
            .map(|cable| cable.force_sensor)
            .collect();
        let (Some(sensors), Some(_)) = (sensors, robot.platform.mass_kg) else {
            return false;
        };
        let (mut left, mut weight) = (0.0, 0.0);
        for (row, pose) in self.rows.iter().zip(&self.poses) {
            let (Ok(matrix), Ok(wrench)) =
                (structure_matrix(robot, pose), applied_wrench(robot, pose))
            else {
                continue;
            };
            let tensions = sensors.iter().zip(channels);
            let tensions =
                tensions.map(|(sensor, channel)| sensor.tension_n(channel.values.at(*row)));
            let tensions = DVector::from_iterator(channels.len(), tensions);
            let rest = matrix.transpose() * tensions + &wrench;
            // Torques depend on where the platform hangs to millimetres; forces do not.
            let coordinates = robot.platform.freedom();
            for (k, coordinate) in coordinates.coordinates().iter().enumerate() {
                if coordinate.index() < 3 {
                    left += rest[k].powi(2);
                    weight += wrench[k].powi(2);
                }
            }
        }
        weight > 0.0 && left < LEFT_OVER * weight
    }
}

//! Readings and constants that the published method takes from a dataset.

use crate::geometry::{Pose, Vec3};
use crate::kinematics::ForwardKinematics;
use crate::measurement::{Dataset, Measurements};
use crate::robot::{Laser, Robot};

use super::PublishedError;

/// Readings and constants, poses in the order of the measurements.
pub(super) struct Readings {
    pub(super) home: Pose,
    /// Start of the forward kinematics at every pose.
    pub(super) starts: Vec<Pose>,
    /// Laser readings (m).
    pub(super) laser_m: Vec<f64>,
    home_row: usize,
    laser: Laser,
    plane_offset_m: f64,
    /// Row-major with one row per pose: length paid out since home (m), and strain `T/EA`.
    paid_out_m: Vec<f64>,
    strain: Vec<f64>,
    length_to_pulley_m: Vec<f64>,
}

impl Readings {
    pub(super) fn new(dataset: &Dataset) -> Result<Self, PublishedError> {
        let missing = |what| PublishedError::Missing { what };
        let (robot, measured) = (&dataset.robot, &dataset.measurements);
        let home = robot.home.ok_or(missing("a home pose"))?;
        let laser = robot.laser.ok_or(missing("a laser distance sensor"))?;
        let home_row = measured.home_row().ok_or(missing("readings at home"))?;
        check(robot, measured)?;
        let home = home.pose();
        let mut readings = Self {
            home,
            starts: Vec::new(),
            laser_m: (0..measured.len()).map(|j| measured.laser_at(j)).collect(),
            home_row,
            laser,
            plane_offset_m: 0.0,
            paid_out_m: Vec::new(),
            strain: Vec::new(),
            length_to_pulley_m: Vec::new(),
        };
        readings.take_cables(robot, measured);
        // The laser reading at home determines the plane offset.
        let (origin, direction) = readings.beam(&home);
        let normal = Vec3::from(laser.target_plane.normal);
        let distance = readings.laser_m[home_row];
        readings.plane_offset_m = normal.dot(&(origin + direction * distance));
        Ok(readings)
    }

    fn take_cables(&mut self, robot: &Robot, measured: &Measurements) {
        let winches = robot.cables.iter().map(|cable| &cable.winch);
        self.length_to_pulley_m = winches.map(|winch| winch.length_to_pulley_m).collect();
        for j in 0..measured.len() {
            for (i, cable) in robot.cables.iter().enumerate() {
                let reading = measured.force_n.get(j, i);
                let tension = cable.force_sensor.map_or(0.0, |s| s.tension_n(reading));
                let stiffness = cable.cable.axial_stiffness_n.unwrap_or(f64::INFINITY);
                self.strain.push(tension / stiffness);
                let per_revolution = cable.winch.cable_per_revolution_m();
                self.paid_out_m
                    .push(per_revolution * measured.revolutions.get(j, i));
            }
        }
    }

    /// Chooses the start of every pose: the commanded pose, or, if it is not given, the forward
    /// kinematics of the robot as described.
    pub(super) fn choose_starts(
        &mut self,
        dataset: &Dataset,
        entries: &[[f64; 3]],
    ) -> Result<(), PublishedError> {
        let mut robot = dataset.robot.clone();
        for (cable, entry) in robot.cables.iter_mut().zip(entries) {
            cable.pulley.entry_point_m = *entry;
        }
        let solver = ForwardKinematics::new(&robot)?;
        let m = robot.cable_count();
        let home = robot.home.map_or_else(Pose::identity, |home| home.pose());
        let at_home = crate::kinematics::inverse_kinematics(&robot, &home)?;
        let at_home: Vec<f64> = at_home.iter().map(|state| state.length_m).collect();
        let lengths = self.measured_lengths(&at_home);
        let starts = (0..self.laser_m.len()).map(|j| {
            let commanded = dataset.measurements.commanded.get(j).copied().flatten();
            let searched = || {
                let own = &lengths[j * m..(j + 1) * m];
                solver.solve_from_anywhere(own).pose
            };
            commanded.unwrap_or_else(searched)
        });
        self.starts = starts.collect();
        Ok(())
    }

    /// Lengths from entry point to anchor under tension (m), row-major, for given lengths at home.
    pub(super) fn measured_lengths(&self, home_lengths_m: &[f64]) -> Vec<f64> {
        let m = self.length_to_pulley_m.len();
        let cells = self.paid_out_m.iter().zip(&self.strain).enumerate();
        cells
            .map(|(cell, (paid_out, strain))| {
                let i = cell % m;
                let to_pulley = self.length_to_pulley_m[i];
                let home_strain = self.strain[self.home_row * m + i];
                let at_home = (to_pulley + home_lengths_m[i]) / (1.0 + home_strain);
                (at_home + paid_out) * (1.0 + strain) - to_pulley
            })
            .collect()
    }

    /// Predicted laser distance (m), equation 8.
    pub(super) fn laser_at(&self, pose: &Pose) -> f64 {
        let (origin, direction) = self.beam(pose);
        let normal = Vec3::from(self.laser.target_plane.normal);
        (self.plane_offset_m - normal.dot(&origin)) / normal.dot(&direction)
    }

    fn beam(&self, pose: &Pose) -> (Vec3, Vec3) {
        let origin = pose.transform(&self.laser.origin_m.into());
        (origin, pose.orientation * Vec3::from(self.laser.direction))
    }
}

/// Rejects data and models that the method cannot handle.
fn check(robot: &Robot, measured: &Measurements) -> Result<(), PublishedError> {
    if !robot.has_force_sensors() {
        let what = "a force sensor on every cable";
        return Err(PublishedError::Missing { what });
    }
    let surfaces = robot.cables.iter().map(|c| &c.cable.elongation_surface);
    if surfaces.flatten().next().is_some() {
        let what = "a measured elongation surface, only a constant axial stiffness";
        return Err(PublishedError::NotModelled { what });
    }
    if robot.effects_and_deviations().next().is_some() {
        let what = "the effects of an extended model";
        return Err(PublishedError::NotModelled { what });
    }
    for (j, label) in measured.labels.iter().enumerate() {
        let cables = 0..robot.cable_count();
        let empty = |what| PublishedError::EmptyCell {
            what,
            label: *label,
        };
        for i in cables {
            if measured.revolutions.get(j, i).is_nan() {
                return Err(empty("the revolutions of every winch"));
            }
            if measured.force_n.get(j, i).is_nan() {
                return Err(empty("the force on every cable"));
            }
        }
        if measured.laser_at(j).is_nan() {
            return Err(empty("a laser distance"));
        }
    }
    Ok(())
}

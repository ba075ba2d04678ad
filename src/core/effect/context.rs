//! Contexts of the readings: everything that effects may depend on besides their parameters.
//!
//! A context follows from the readings and from the nominal geometry at approximate poses. It is
//! computed once per problem and held fixed while parameters and poses are estimated.

use super::direction::angles;
use super::motion::{finite, inertia, paid_rates, tension_rates, twists};
use super::{Dual, PlatformPorts};
use crate::geometry::{Pose, Twist};
use crate::kinematics::{PulleyGeometry, balanced_tension, swivel_angle};
use crate::measurement::{Grid, Measurements};
use crate::robot::{Cable, Robot};

/// Context of the readings of one cable at one pose.
#[derive(Debug, Clone, Copy)]
pub struct CableContext {
    /// Whether this is the home pose, at which the encoders were zeroed.
    pub is_home: bool,
    /// Label of the pose.
    pub label: i64,
    /// Time since the home row, or the first row if there is none (s); 0 if not measured.
    pub time_s: f64,
    /// Change of temperature since the home row, or the first row (K); 0 if not measured.
    pub temperature_change_k: f64,
    /// Motor revolutions since home; 0 where lengths are read directly.
    pub revolutions: f64,
    /// Drum revolutions per motor revolution.
    pub drum_per_motor: f64,
    /// +1 where the cable was paid out since the previous row, -1 where it was reeled in, else 0: from the readings, or from
    /// approximate poses where one is missing.
    pub direction: f64,
    /// First and second derivative of the cable paid out, or the length, with respect to time (m/s, m/s^2); 0 at rest.
    pub paid_rates: [f64; 2],
    /// First and second time derivative of the tension reading (N/s, N/s^2).
    pub tension_rates: [f64; 2],
    /// Tension by the fit that the poses are from, else as read, or the mean tension where it was not read (N); if the cable
    /// has no reading at all, a tension within the stated limits that balances the platform, 0 if no limits are stated.
    pub tension_n: f64,
    /// Mean of the known tensions over all rows (N).
    pub mean_tension_n: f64,
    /// Gain of the force sensor, reading per tension; 0 where it is not read.
    pub tension_gain: f64,
    /// Wrap angle on the pulley, nominal geometry at an approximate pose (rad).
    pub wrap_rad: f64,
    /// Horizontal components of the unit vector from the pulley to the platform, from the same geometry and pose.
    pub pull_horizontal: [f64; 3],
    /// Nominal entry point (m).
    pub entry_point_m: [f64; 3],
    /// Nominal swivel axis.
    pub swivel_axis: [f64; 3],
    /// Cable paid out since home according to the reading, or the length read (m); 0 where not read.
    pub paid_m: f64,
    /// Length from pulley to platform, nominal geometry at an approximate pose (m).
    pub length_m: f64,
    /// Swivel angle from the same geometry and pose (rad); 0 without a zero direction.
    pub swivel_rad: f64,
    /// Nominal pulley radius (m).
    pub radius_m: f64,
}

/// Context of the platform's readings at one pose.
#[derive(Debug, Clone, Copy)]
pub struct PlatformContext {
    /// Whether this is the home pose.
    pub is_home: bool,
    /// Row in the measurements.
    pub row: usize,
    /// Label of the pose.
    pub label: i64,
    /// Time since the home row, or the first row if there is none (s); 0 if not measured.
    pub time_s: f64,
    /// Change of temperature since the home row, or the first row (K); 0 if not measured.
    pub temperature_change_k: f64,
    /// Laser reading (m); 0 without one.
    pub laser_m: f64,
    /// First and second derivative of the laser reading with respect to time (m/s, m/s^2); 0 at rest.
    pub laser_rates: [f64; 2],
    /// Velocity and acceleration of the platform (m, rad, s; base frame); 0 at rest.
    pub twists: [Twist; 2],
    /// Acceleration of the centre of mass (m/s^2), then the torque that rotates the platform about it (N m); base frame.
    pub inertia: Twist,
    /// Roll, pitch and yaw as read (rad); of an approximate pose where not read.
    pub inclination_rad: [f64; 3],
    /// Position as read by the external instrument (m); 0 where not read.
    pub tracked_m: [f64; 3],
    /// Rotation matrix of the orientation that it read, row by row; of an approximate pose where not read.
    pub tracked_rotation: [[f64; 3]; 3],
    /// Nominal direction of the laser beam, platform frame; arbitrary without a laser.
    pub laser_direction: [f64; 3],
    /// Nominal normal of the target plane, base frame; arbitrary without a laser.
    pub target_normal: [f64; 3],
    /// Approximate position (m).
    pub position_m: [f64; 3],
    /// Rotation vector of the approximate orientation, base frame (rad).
    pub rotation_rad: [f64; 3],
}

/// Contexts of all readings of one row.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RowContexts<'c> {
    pub cables: &'c [CableContext],
    pub platform: &'c PlatformContext,
}

impl CableContext {
    /// Whether this is the pose with this label or a later one; the home pose precedes all others.
    /// NaN stands for every pose, so that a search covers all of them at once.
    pub fn is_from(&self, label: f64) -> bool {
        !self.is_home && (label.is_nan() || self.label as f64 >= label)
    }

    /// Whether this is the pose with this label, and not the home pose; NaN stands for every pose.
    pub fn is_at(&self, label: f64) -> bool {
        !self.is_home && (label.is_nan() || self.label as f64 == label)
    }
}

impl PlatformContext {
    /// Whether this is the pose with this label or a later one; the home pose precedes all others. NaN stands for every
    /// pose.
    pub fn is_from(&self, label: f64) -> bool {
        !self.is_home && (label.is_nan() || self.label as f64 >= label)
    }

    /// Whether this is the pose with this label; NaN stands for every pose.
    pub fn is_at(&self, label: f64) -> bool {
        label.is_nan() || self.label as f64 == label
    }
}

/// Inputs that a fit or a simulation knows better than the readings do; indexed by `(row, cable)`.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct BetterKnown<'k> {
    /// Directions of travel.
    pub directions: Option<&'k Grid>,
    /// Tensions (N). The noise of a reading would be in the effect and in the residuals alike, and their product would be
    /// taken for evidence.
    pub tensions_n: Option<&'k Grid>,
}

/// Contexts of all rows of a dataset.
#[derive(Debug, Clone)]
pub(crate) struct PoseContexts {
    cable_count: usize,
    cables: Vec<CableContext>,
    platform: Vec<PlatformContext>,
}

pub(super) fn or_zero(value: Option<f64>) -> f64 {
    value.filter(|v| v.is_finite()).unwrap_or(0.0)
}

impl PoseContexts {
    /// Computes the contexts for a platform at approximate poses, one per row. Directions of travel and tensions are
    /// taken from the readings unless they are better known.
    pub fn new(
        robot: &Robot,
        data: &Measurements,
        home: Option<usize>,
        poses: &[Pose],
        known: BetterKnown<'_>,
    ) -> Self {
        // Counts from the first reading if there is none at home.
        let since = |column: &[f64], row: usize| {
            let read = |row: usize| column.get(row).copied().filter(|v| v.is_finite());
            let first = || column.iter().copied().find(|v| v.is_finite());
            let from = read(home.unwrap_or(0)).or_else(first);
            read(row)
                .zip(from)
                .map_or(0.0, |(value, from)| value - from)
        };
        let nominal = PlatformPorts::nominal(robot);
        let rates = data.rates.as_ref();
        let motion = |row: usize| match rates {
            Some(rates) => twists(robot, data, rates, row, &poses[row]),
            None => <[Twist; 2]>::default(),
        };
        let moving: Vec<[Twist; 2]> = (0..data.len()).map(motion).collect();
        let platform: Vec<_> = (0..data.len())
            .map(|row| PlatformContext {
                is_home: home == Some(row),
                row,
                label: data.labels[row],
                time_s: since(&data.time_s, row),
                temperature_change_k: since(&data.temperature_c, row),
                laser_m: or_zero(data.laser_m.get(row).copied()),
                laser_rates: rates.map_or([0.0; 2], |rates| finite(rates.laser.get(row).copied())),
                twists: moving[row],
                inertia: inertia(robot, &poses[row], &moving[row]),
                laser_direction: nominal.laser_direction.map(|d| d.value),
                target_normal: nominal.target_normal.map(|d| d.value),
                inclination_rad: inclination(data, row, &poses[row]),
                tracked_m: (data.tracked_position_m.get(row))
                    .map_or([0.0; 3], |read| read.map(|value| or_zero(Some(value)))),
                tracked_rotation: tracked_rotation(data, row, &poses[row]),
                position_m: poses[row].position.into(),
                rotation_rad: poses[row].orientation.scaled_axis().into(),
            })
            .collect();
        let tension = tensions(robot, data, poses, known.tensions_n);
        let means: Vec<f64> = (0..robot.cable_count())
            .map(|index| mean_tension(&tension, index))
            .collect();
        let down = robot.gravity().try_normalize(0.0).unwrap_or_default();
        let mut cables: Vec<CableContext> = Vec::with_capacity(data.len() * robot.cable_count());
        // Lengths at the previous row.
        let mut before: Vec<Option<f64>> = vec![None; robot.cable_count()];
        for at in &platform {
            for (index, cable) in robot.cables.iter().enumerate() {
                let row = at.row;
                let anchor = poses[row].position
                    + poses[row].orientation * nalgebra::Vector3::from(cable.platform_anchor_m);
                let path = pulley_of(cable).path_to(anchor.into());
                let pull = -nalgebra::Vector3::from(path.toward_exit);
                let from = before[index].replace(path.length);
                let paid_rates = paid_rates(cable, data, (row, index));
                let direction = match known.directions {
                    Some(grid) => grid.get(row, index),
                    None if rates.is_some() => sign(paid_rates[0]),
                    // Where a reading is missing, the direction follows from the two poses.
                    None => data
                        .travel_before(home, (row, index))
                        .unwrap_or_else(|| from.map_or(0.0, |from| sign(path.length - from))),
                };
                let tension_n = tension.get(row, index);
                let is_read = !data.force_n.is_empty();
                cables.push(CableContext {
                    is_home: at.is_home,
                    label: at.label,
                    time_s: at.time_s,
                    temperature_change_k: at.temperature_change_k,
                    revolutions: paid_revolutions(data, home, (row, index)),
                    drum_per_motor: cable.winch.gear_ratio.recip(),
                    direction,
                    paid_rates,
                    tension_rates: tension_rates(cable, data, (row, index)),
                    tension_n: if tension_n.is_finite() {
                        tension_n
                    } else {
                        means[index]
                    },
                    mean_tension_n: means[index],
                    tension_gain: (cable.force_sensor.filter(|_| is_read))
                        .map_or(0.0, |s| s.tension_gain),
                    wrap_rad: path.wrap,
                    pull_horizontal: (pull - down * down.dot(&pull)).into(),
                    entry_point_m: cable.pulley.entry_point_m,
                    swivel_axis: cable.pulley.swivel_axis,
                    paid_m: paid(cable, data, home, (row, index)),
                    length_m: path.length,
                    swivel_rad: swivel_angle(cable, &path).ok().flatten().unwrap_or(0.0),
                    radius_m: cable.pulley.radius_m,
                });
            }
        }
        Self {
            cable_count: robot.cable_count(),
            cables,
            platform,
        }
    }

    /// Contexts of all readings at a row.
    pub fn at_row(&self, row: usize) -> RowContexts<'_> {
        let first = row * self.cable_count;
        RowContexts {
            cables: &self.cables[first..first + self.cable_count],
            platform: &self.platform[row],
        }
    }

    /// Context of a cable at a row.
    pub fn cable(&self, row: usize, index: usize) -> &CableContext {
        &self.cables[row * self.cable_count + index]
    }

    /// Context of the platform at a row.
    pub fn platform(&self, row: usize) -> &PlatformContext {
        &self.platform[row]
    }
}

/// Roll, pitch and yaw as read (rad), completed by those of the pose: a tilted sensor mixes all three.
fn inclination(data: &Measurements, row: usize, pose: &Pose) -> [f64; 3] {
    let rotation = pose.orientation.to_rotation_matrix().into_inner();
    let rows: [[f64; 3]; 3] = rotation.transpose().into();
    let at_pose = angles(&rows.map(|row| row.map(Dual::constant)));
    let read = data.inclination_rad.get(row).copied();
    let read = read.unwrap_or([f64::NAN; 3]);
    std::array::from_fn(|k| {
        if read[k].is_nan() {
            at_pose[k].value
        } else {
            read[k]
        }
    })
}

/// The orientation as read by the external instrument, else that of the pose, as rows of its matrix.
fn tracked_rotation(data: &Measurements, row: usize, pose: &Pose) -> [[f64; 3]; 3] {
    let read = data.tracked_orientation_at(row).unwrap_or(pose.orientation);
    // The columns of the transpose are the rows.
    read.to_rotation_matrix().into_inner().transpose().into()
}

fn pulley_of(cable: &Cable) -> PulleyGeometry<f64> {
    PulleyGeometry {
        entry: cable.pulley.entry_point_m,
        axis: cable.pulley.swivel_axis,
        radius: cable.pulley.radius_m,
    }
}

/// Tensions behind the readings (N), as `known` or as read; where there is no reading at all, tensions within the stated limits
/// that balance the platform, as close as possible to the reference. NaN where neither is known.
fn tensions(robot: &Robot, data: &Measurements, poses: &[Pose], known: Option<&Grid>) -> Grid {
    let mut found = Grid::missing(data.len(), robot.cable_count());
    let limits = robot.unread_tension().filter(|_| data.force_n.is_empty());
    for row in 0..data.len() {
        let held = limits.map(|limits| balanced_tension(robot, &poses[row], &limits));
        for (index, cable) in robot.cables.iter().enumerate() {
            let read = || {
                let read = (cable.force_sensor?).tension_n(data.force_n.get(row, index));
                let known = known.map(|known| known.get(row, index));
                known
                    .filter(|t| t.is_finite() && read.is_finite())
                    .or(Some(read))
            };
            let held = held.as_ref().map(|held| held[index]);
            if let Some(tension) = held.or_else(read).filter(|t| t.is_finite()) {
                found.set(row, index, tension);
            }
        }
    }
    found
}

/// Cable paid out since home, or the length read (m); 0 where not read.
fn paid(cable: &Cable, data: &Measurements, home: Option<usize>, at: (usize, usize)) -> f64 {
    if data.revolutions.is_empty() {
        return or_zero(Some(data.length_m.get(at.0, at.1)));
    }
    cable.winch.cable_per_revolution_m() * paid_revolutions(data, home, at)
}

fn mean_tension(tension: &Grid, index: usize) -> f64 {
    let known: Vec<f64> = (0..tension.rows())
        .map(|row| tension.get(row, index))
        .filter(|t| t.is_finite())
        .collect();
    known.iter().sum::<f64>() / known.len().max(1) as f64
}

fn paid_revolutions(data: &Measurements, home: Option<usize>, at: (usize, usize)) -> f64 {
    if home == Some(at.0) {
        return 0.0;
    }
    or_zero(Some(data.revolutions.get(at.0, at.1)))
}

/// Sign of the change of the length reading of a `(row, cable)` since the previous row; 0 where unknown.
pub(crate) fn travel(data: &Measurements, home: Option<usize>, at: (usize, usize)) -> f64 {
    data.travel_before(home, at).unwrap_or(0.0)
}

/// +1, -1, or 0 for no change and where it is unknown.
pub(crate) fn sign(change: f64) -> f64 {
    if change > 0.0 {
        1.0
    } else if change < 0.0 {
        -1.0
    } else {
        0.0
    }
}

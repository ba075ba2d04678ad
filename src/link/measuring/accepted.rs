//! What was measured at a pose.

use tautline_core::geometry::Pose;
use tautline_core::measurement::{Grid, Measurements};
use tautline_core::robot::Robot;
use tautline_session::MeasuredPose;

use crate::controller::Sample;

/// Mean readings at a pose; NaN where nothing was read.
#[derive(Debug, Clone, PartialEq)]
pub struct Accepted {
    /// Label of the pose; 0 is home.
    pub label: i64,
    /// Commanded pose.
    pub commanded: Pose,
    /// Mean time by the controller's clock (s).
    pub time_s: f64,
    /// Temperature (degrees Celsius).
    pub temperature_c: f64,
    /// Motor revolutions per cable.
    pub revolutions: Vec<f64>,
    /// Raw force readings per cable (N); empty without sensors.
    pub force_n: Vec<f64>,
    /// Laser distance (m).
    pub laser_m: f64,
    /// Swivel angles per cable (rad); empty without sensors.
    pub swivel_rad: Vec<f64>,
    /// Roll, pitch and yaw (rad), where measured.
    pub inclination_rad: Option<[f64; 3]>,
    /// Standard deviation of single samples of the revolutions.
    pub revolutions_sd: Vec<f64>,
    /// Standard deviation of single samples of the forces (N).
    pub force_sd_n: Vec<f64>,
    /// Standard deviation of single samples of the laser (m).
    pub laser_sd_m: f64,
    /// Number of samples.
    pub samples: usize,
    /// What was noticed, as for the operator.
    pub notes: Vec<String>,
}

impl Accepted {
    /// The mean of samples taken at a pose.
    #[must_use]
    pub fn mean_of(label: i64, commanded: Pose, samples: &[Sample]) -> Self {
        let cables = samples.first().map_or(0, |s| s.revolutions.len());
        let forces = samples.first().map_or(0, |s| s.force_n.len());
        let swivels = samples.iter().any(|s| s.swivel_rad.is_some());
        let column = |get: &dyn Fn(&Sample) -> Option<f64>| mean_and_sd(samples, get);
        let of_cable = |count: usize, get: &dyn Fn(&Sample, usize) -> Option<f64>| {
            let cells = (0..count).map(|cable| column(&|s| get(s, cable)));
            cells.unzip::<f64, f64, Vec<f64>, Vec<f64>>()
        };
        let (revolutions, revolutions_sd) =
            of_cable(cables, &|s, cable| s.revolutions.get(cable).copied());
        let (force_n, force_sd_n) = of_cable(forces, &|s, cable| s.force_n.get(cable).copied());
        let (swivel_rad, _) = of_cable(if swivels { cables } else { 0 }, &|s, cable| {
            s.swivel_rad.as_ref()?.get(cable).copied()
        });
        let (laser_m, laser_sd_m) = column(&|s| s.laser_m);
        let inclined = samples.iter().any(|s| s.inclination_rad.is_some());
        let angle = |k: usize| column(&|s| s.inclination_rad.map(|angles| angles[k])).0;
        Self {
            label,
            commanded,
            time_s: column(&|s| Some(s.time_s)).0,
            temperature_c: column(&|s| s.temperature_c).0,
            revolutions,
            force_n,
            laser_m,
            swivel_rad,
            inclination_rad: inclined.then(|| std::array::from_fn(angle)),
            revolutions_sd,
            force_sd_n,
            laser_sd_m,
            samples: samples.len(),
            notes: Vec::new(),
        }
    }

    /// The readings as a session takes them.
    #[must_use]
    pub fn measured_pose(&self) -> MeasuredPose {
        let known = |value: f64| Some(value).filter(|value| value.is_finite());
        MeasuredPose {
            label: self.label,
            time_s: known(self.time_s),
            temperature_c: known(self.temperature_c),
            commanded: Some(self.commanded),
            revolutions: self.revolutions.clone(),
            force_n: self.force_n.clone(),
            laser_m: known(self.laser_m),
            swivel_rad: self.swivel_rad.clone(),
            inclination_rad: self.inclination_rad,
            ..MeasuredPose::default()
        }
    }
}

/// Mean and standard deviation of what was read; NaN where nothing was, and for the deviation of one value.
fn mean_and_sd(samples: &[Sample], get: &dyn Fn(&Sample) -> Option<f64>) -> (f64, f64) {
    let values = samples.iter().filter_map(get);
    let values: Vec<f64> = values.filter(|value| value.is_finite()).collect();
    let n = values.len() as f64;
    // About the first value: bit-identical readings have themselves as mean and no deviation.
    let first = values.first().copied().unwrap_or(f64::NAN);
    let mean = first + values.iter().map(|v| v - first).sum::<f64>() / n;
    let square: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
    let sd = if n > 1.0 {
        (square / (n - 1.0)).sqrt()
    } else {
        f64::NAN
    };
    (mean, sd)
}

/// The measurements that accepted poses make, in their order; a quantity that was never read has no column.
#[must_use]
pub fn measurements_of(robot: &Robot, accepted: &[Accepted]) -> Measurements {
    let cables = robot.cable_count();
    let grid = |get: &dyn Fn(&Accepted) -> &[f64]| {
        let mut grid = Grid::new(cables);
        if accepted.iter().all(|row| get(row).is_empty()) {
            return Grid::default();
        }
        for row in accepted {
            let mut values = get(row).to_vec();
            values.resize(cables, f64::NAN);
            grid.push_row(&values);
        }
        grid
    };
    let column = |get: &dyn Fn(&Accepted) -> f64| {
        let values: Vec<f64> = accepted.iter().map(get).collect();
        let read = values.iter().any(|value| !value.is_nan());
        if read { values } else { Vec::new() }
    };
    let inclined = accepted.iter().any(|row| row.inclination_rad.is_some());
    let angles = accepted.iter().map(|row| row.inclination_rad);
    Measurements {
        labels: accepted.iter().map(|row| row.label).collect(),
        time_s: column(&|row| row.time_s),
        temperature_c: column(&|row| row.temperature_c),
        commanded: accepted.iter().map(|row| Some(row.commanded)).collect(),
        revolutions: grid(&|row| &row.revolutions),
        force_n: grid(&|row| &row.force_n),
        laser_m: column(&|row| row.laser_m),
        swivel_rad: grid(&|row| &row.swivel_rad),
        inclination_rad: match inclined {
            true => angles.map(|a| a.unwrap_or([f64::NAN; 3])).collect(),
            false => Vec::new(),
        },
        ..Measurements::default()
    }
}

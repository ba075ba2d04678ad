//! Noise of the readings, implemented independently of the simulator.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};
use tautline_core::geometry::{Pose, Twist};
use tautline_core::measurement::{Grid, Measurements};
use tautline_core::robot::{PerAxis, Robot};

/// Ratio of actual and described standard deviation for each kind of reading.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct NoiseFactors {
    /// Lengths.
    pub length: f64,
    /// Tensions.
    pub tension: f64,
    /// Laser.
    pub laser: f64,
    /// Swivel angles.
    pub swivel: f64,
    /// Roll, pitch and yaw.
    pub inclination: f64,
    /// Position by the external instrument.
    pub position: f64,
    /// Orientation by the external instrument.
    pub orientation: f64,
}

impl Default for NoiseFactors {
    fn default() -> Self {
        Self::each(|| 1.0)
    }
}

impl NoiseFactors {
    /// Calls `value` once for each kind of reading.
    pub fn each(mut value: impl FnMut() -> f64) -> Self {
        Self {
            length: value(),
            tension: value(),
            laser: value(),
            swivel: value(),
            inclination: value(),
            position: value(),
            orientation: value(),
        }
    }

    /// Multiplies all ratios by a factor.
    #[must_use]
    pub fn times(self, factor: f64) -> Self {
        let all = [
            self.length,
            self.tension,
            self.laser,
            self.swivel,
            self.inclination,
            self.position,
            self.orientation,
        ];
        let mut all = all.into_iter();
        Self::each(|| factor * all.next().unwrap_or_default())
    }

    /// The description with the actual noise.
    #[must_use]
    pub fn of(self, stated: &Robot) -> Robot {
        let mut robot = stated.clone();
        for cable in &mut robot.cables {
            cable.winch.length_sd_m *= self.length;
            cable.pulley.swivel_sd_rad = cable.pulley.swivel_sd_rad.map(|sd| sd * self.swivel);
            if let Some(sensor) = &mut cable.force_sensor {
                sensor.tension_sd_n *= self.tension;
            }
        }
        if let Some(laser) = &mut robot.laser {
            laser.sd_m *= self.laser;
        }
        if let Some(sensor) = &mut robot.inclinometer {
            sensor.sd_rad *= self.inclination;
        }
        if let Some(tracker) = &mut robot.tracker {
            let sd = tracker.position_sd_m.each();
            tracker.position_sd_m = PerAxis::Each(sd.map(|sd| sd * self.position));
            tracker.orientation_sd_rad = tracker.orientation_sd_rad.map(|sd| sd * self.orientation);
        }
        robot
    }
}

/// Normal random number (Box and Muller).
pub fn normal(rng: &mut ChaCha8Rng, sd: f64) -> f64 {
    let radius = (-2.0 * rng.random_range(f64::MIN_POSITIVE..1.0).ln()).sqrt();
    sd * radius * (std::f64::consts::TAU * rng.random_range(0.0..1.0)).cos()
}

/// Random number from Student's t distribution with an integer number of degrees of freedom, scaled to a standard
/// deviation.
fn student(rng: &mut ChaCha8Rng, freedom: f64, sd: f64) -> f64 {
    let squares: f64 = (0..freedom as usize)
        .map(|_| normal(rng, 1.0).powi(2))
        .sum();
    sd * normal(rng, 1.0) * ((freedom - 2.0) / squares).sqrt()
}

/// Adds the noise of `robot` to all readings, t distributed if `tails` has degrees of freedom.
pub fn add_noise(robot: &Robot, data: &mut Measurements, tails: Option<f64>, rng: &mut ChaCha8Rng) {
    let mut draw = |sd: f64| match tails {
        None => normal(rng, sd),
        Some(freedom) => student(rng, freedom, sd),
    };
    let home = robot.home.and(data.home_row());
    for row in 0..data.len() {
        for (index, cable) in robot.cables.iter().enumerate() {
            let mut add = |grid: &mut Grid, sd: f64| {
                if !grid.is_empty() {
                    grid.set(row, index, grid.get(row, index) + draw(sd));
                }
            };
            let winch = &cable.winch;
            // At home the encoders are set to zero, so they have no noise there.
            if Some(row) != home {
                let sd = winch.length_sd_m / winch.cable_per_revolution_m();
                add(&mut data.revolutions, sd);
            }
            add(&mut data.length_m, winch.length_sd_m);
            if let Some(sensor) = cable.force_sensor {
                let sd = sensor.tension_gain.abs() * sensor.tension_sd_n;
                add(&mut data.force_n, sd);
            }
            let sd = cable.pulley.swivel_sd_rad.unwrap_or(0.0);
            add(&mut data.swivel_rad, sd);
        }
        if let (Some(laser), Some(reading)) = (&robot.laser, data.laser_m.get_mut(row)) {
            *reading += draw(laser.sd_m);
        }
        if let (Some(sensor), Some(angles)) =
            (&robot.inclinometer, data.inclination_rad.get_mut(row))
        {
            angles
                .iter_mut()
                .for_each(|angle| *angle += draw(sensor.sd_rad));
        }
        let Some(tracker) = &robot.tracker else {
            continue;
        };
        if let Some(position) = data.tracked_position_m.get_mut(row) {
            for (value, sd) in position.iter_mut().zip(tracker.position_sd_m.each()) {
                *value += draw(sd);
            }
        }
        let orientation = data.tracked_orientation_wxyz.get_mut(row);
        if let (Some(sd), Some(q)) = (tracker.orientation_sd_rad, orientation) {
            let turn = Twist::from_fn(|k, _| if k < 3 { 0.0 } else { draw(sd) });
            let turned = Pose::from_parts([0.0; 3], *q).perturbed(&turn);
            *q = turned.orientation_wxyz();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;

    #[test]
    fn both_distributions_have_the_given_standard_deviation_and_one_has_heavier_tails() {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let mut of = |tails: Option<f64>| {
            let draws: Vec<f64> = (0..40_000)
                .map(|_| match tails {
                    None => normal(&mut rng, 2.0),
                    Some(freedom) => student(&mut rng, freedom, 2.0),
                })
                .collect();
            let squares: f64 = draws.iter().map(|x| x * x).sum();
            let far = draws.iter().filter(|x| x.abs() > 8.0).count();
            ((squares / draws.len() as f64).sqrt(), far)
        };
        let (sd, far) = of(None);
        // The standard error of the standard deviation is 0.007. More than 20 of 40,000 values beyond four standard
        // deviations have a probability below 1e-9.
        assert!((sd - 2.0).abs() < 0.04 && far < 20, "{sd} {far}");
        let (sd, far) = of(Some(6.0));
        assert!((sd - 2.0).abs() < 0.1 && far > 40, "{sd} {far}");
    }
}

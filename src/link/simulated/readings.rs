//! Readings as one row of numbers, for interpolation.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;
use tautline_core::measurement::Measurements;
use tautline_core::robot::Robot;

use super::setup::SimulatedSetup;
use crate::controller::Sample;

/// One value per channel: revolutions, forces, swivel angles of the cables, laser, three inclinations; NaN without
/// the instrument.
pub(super) type ReadingRow = Vec<f64>;

fn channels(cables: usize) -> usize {
    3 * cables + 4
}

/// The row of exact readings.
pub(super) fn row_of(data: &Measurements, cables: usize) -> ReadingRow {
    let grids = [&data.revolutions, &data.force_n, &data.swivel_rad];
    let of_cables = grids
        .into_iter()
        .flat_map(|grid| (0..cables).map(|cable| grid.get(0, cable)));
    let inclination = data.inclination_rad.first().copied();
    of_cables
        .chain([data.laser_at(0)])
        .chain(inclination.unwrap_or([f64::NAN; 3]))
        .collect()
}

/// The sample for a row, without time, temperature and commanded pose.
pub(super) fn sample_of(row: &[f64], cables: usize, laser_range_m: [f64; 2]) -> Sample {
    let part = |index: usize| row[index * cables..(index + 1) * cables].to_vec();
    let known = |values: Vec<f64>| values.iter().all(|v| !v.is_nan()).then_some(values);
    let laser = row[3 * cables];
    let [low, high] = laser_range_m;
    let inclination_rad = std::array::from_fn(|k| row[3 * cables + 1 + k]);
    Sample {
        time_s: 0.0,
        revolutions: part(0),
        force_n: known(part(1)).unwrap_or_default(),
        swivel_rad: known(part(2)),
        laser_m: (laser >= low && laser <= high).then_some(laser),
        inclination_rad: Some(inclination_rad).filter(|a: &[f64; 3]| !a[0].is_nan()),
        temperature_c: None,
        commanded: None,
        started: None,
    }
}

/// Noise with a part that is constant while the platform stays, and an independent part per sample.
///
/// With the standard deviation `s` of the description, the share `q` and `n` averaged samples, the parts have
/// the variances `q s^2` and `(1 - q) n s^2`: so the mean of `n` samples has `s`, that of many `sqrt(q) s`.
pub(super) struct Noise {
    rng: ChaCha8Rng,
    sd: ReadingRow,
    repeating: f64,
    fleeting: f64,
    offset: ReadingRow,
}

impl Noise {
    pub fn new(setup: &SimulatedSetup, rng: ChaCha8Rng) -> Self {
        let size = if setup.noise { 1.0 } else { 0.0 };
        let share = setup.repeating_share.clamp(0.0, 1.0);
        let averaged = setup.averaged_samples.max(1) as f64;
        let sd = standard_deviations(&setup.nominal);
        Self {
            rng,
            offset: vec![0.0; sd.len()],
            sd,
            repeating: size * share.sqrt(),
            fleeting: size * ((1.0 - share) * averaged).sqrt(),
        }
    }

    fn draw(&mut self, size: f64) -> ReadingRow {
        let Self { rng, sd, .. } = self;
        sd.iter()
            .map(|sd| size * sd * rng.sample::<f64, _>(StandardNormal))
            .collect()
    }

    /// Draws the constant part anew, for another place of the platform.
    pub fn renew(&mut self) {
        self.offset = self.draw(self.repeating);
    }

    /// Adds noise to a row; encoders that have just been zeroed have none.
    pub fn add_to(&mut self, row: &mut [f64], zeroed_cables: usize) {
        let fleeting = self.draw(self.fleeting);
        let noise = self.offset.iter().zip(fleeting);
        for (value, (offset, fleeting)) in row.iter_mut().zip(noise).skip(zeroed_cables) {
            *value += offset + fleeting;
        }
    }
}

fn standard_deviations(robot: &Robot) -> ReadingRow {
    let cables = robot.cables.len();
    let mut sd = vec![0.0; channels(cables)];
    for (index, cable) in robot.cables.iter().enumerate() {
        sd[index] = cable.winch.length_sd_m / cable.winch.cable_per_revolution_m();
        if let Some(sensor) = cable.force_sensor {
            sd[cables + index] = sensor.tension_gain.abs() * sensor.tension_sd_n;
        }
        sd[2 * cables + index] = cable.pulley.swivel_sd_rad.unwrap_or(0.0);
    }
    sd[3 * cables] = robot.laser.map_or(0.0, |laser| laser.sd_m);
    let inclinometer_sd = robot.inclinometer.map_or(0.0, |sensor| sensor.sd_rad);
    sd[3 * cables + 1..].fill(inclinometer_sd);
    sd
}

//! Mild model error: a smooth error in every channel, unlike any effect of the catalogue.

use nalgebra::{DMatrix, DVector};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use tautline_core::geometry::Vec3;
use tautline_core::kinematics::inverse_kinematics;
use tautline_core::measurement::{Grid, Measurements};
use tautline_core::robot::Robot;

/// Number of waves whose sum is the error.
const WAVES: usize = 3;
/// Range of the number of waves across the measured positions.
const FREQUENCY: [f64; 2] = [0.5, 1.2];

/// Adds a smooth function of the position, of root mean square `size` in described standard deviations, to every
/// channel of lengths, tensions and laser. It is orthogonal to what effects of the catalogue express: it has no
/// constant, no slope and no curvature in length, tension, time or position.
pub fn add_model_error(truth: &Robot, data: &mut Measurements, size: f64, rng: &mut ChaCha8Rng) {
    let poses = data.truth.poses.clone();
    let states: Vec<_> = poses
        .iter()
        .map(|pose| inverse_kinematics(truth, pose).unwrap_or_default())
        .collect();
    let places: Vec<Vec3> = poses.iter().map(|pose| pose.position).collect();
    let home = truth.home.and(data.home_row());
    for (index, cable) in truth.cables.iter().enumerate() {
        let of_cable = |of: &dyn Fn(usize) -> f64| (0..poses.len()).map(of).collect::<Vec<f64>>();
        let length = of_cable(&|row| states[row].get(index).map_or(0.0, |s| s.length_m));
        let tension = of_cable(&|row| data.truth.tension_n.get(row, index));
        let mut alike = vec![length];
        if !data.truth.tension_n.is_empty() {
            alike.push(tension);
        }
        let mut add = |grid: &mut Grid, sd: f64| {
            let error = smooth(&places, &alike, &data.time_s, rng);
            for (row, error) in error.iter().enumerate() {
                // At home the encoders are set to zero, so they have no error there.
                if !grid.is_empty() && Some(row) != home {
                    grid.set(row, index, grid.get(row, index) + size * sd * error);
                }
            }
        };
        let winch = &cable.winch;
        add(
            &mut data.revolutions,
            winch.length_sd_m / winch.cable_per_revolution_m(),
        );
        add(&mut data.length_m, winch.length_sd_m);
        if let Some(sensor) = cable.force_sensor {
            add(
                &mut data.force_n,
                sensor.tension_gain.abs() * sensor.tension_sd_n,
            );
        }
    }
    if let Some(laser) = &truth.laser {
        let error = smooth(
            &places,
            std::slice::from_ref(&data.laser_m),
            &data.time_s,
            rng,
        );
        let readings = data.laser_m.iter_mut().zip(error);
        readings.for_each(|(reading, error)| *reading += size * laser.sd_m * error);
    }
}

/// A sum of waves over positions of root mean square 1, orthogonal to a constant and to position, time and the
/// variables `alike`, each with its square.
fn smooth(places: &[Vec3], alike: &[Vec<f64>], time_s: &[f64], rng: &mut ChaCha8Rng) -> Vec<f64> {
    let count = places.len();
    let infinite = Vec3::repeat(f64::INFINITY);
    let low = places.iter().fold(infinite, |a, b| a.inf(b));
    let high = places.iter().fold(-infinite, |a, b| a.sup(b));
    let range = (high - low).amax().max(1e-9);
    let mut error = DVector::zeros(count);
    for _ in 0..WAVES {
        let direction = loop {
            let v = Vec3::from_fn(|_, _| rng.random_range(-1.0..1.0));
            if (0.1..1.0).contains(&v.norm()) {
                break v.normalize();
            }
        };
        let waves = std::f64::consts::TAU * rng.random_range(FREQUENCY[0]..FREQUENCY[1]) / range;
        let phase = rng.random_range(0.0..std::f64::consts::TAU);
        for (value, place) in error.iter_mut().zip(places) {
            *value += (waves * direction.dot(&(place - low)) + phase).sin();
        }
    }
    let mut columns = vec![vec![1.0; count]];
    let axes = (0..3).map(|k| places.iter().map(|place| place[k]).collect::<Vec<f64>>());
    for column in axes.chain(alike.iter().cloned()).chain([time_s.to_vec()]) {
        let middle = column.iter().sum::<f64>() / count as f64;
        let about: Vec<f64> = column.iter().map(|v| v - middle).collect();
        columns.push(about.iter().map(|v| v * v).collect());
        columns.push(about);
    }
    let design = DMatrix::from_fn(count, columns.len(), |row, k| {
        let length = columns[k].iter().map(|v| v * v).sum::<f64>().sqrt();
        columns[k][row] / length.max(1e-12)
    });
    if let Ok(explained) = design.clone().svd(true, true).solve(&error, 1e-9) {
        error -= design * explained;
    }
    let rms = (error.norm_squared() / count as f64).sqrt().max(1e-12);
    error.iter().map(|v| v / rms).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;

    #[test]
    fn a_smooth_error_has_unit_size_and_no_constant_slope_or_curvature() {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let mut place = || Vec3::from_fn(|_, _| rng.random_range(-1.0..1.0));
        let places: Vec<Vec3> = (0..41).map(|_| place()).collect();
        let length: Vec<f64> = places
            .iter()
            .map(|p| (p - Vec3::new(3.0, 2.0, 1.0)).norm())
            .collect();
        let time: Vec<f64> = (0..41).map(f64::from).collect();
        let error = smooth(&places, std::slice::from_ref(&length), &time, &mut rng);
        let mean = |of: &dyn Fn(usize) -> f64| (0..41).map(of).sum::<f64>() / 41.0;
        assert!((mean(&|k| error[k].powi(2)) - 1.0).abs() < 1e-9);
        for power in 0..3 {
            assert!(mean(&|k| error[k] * length[k].powi(power)).abs() < 1e-9);
            assert!(mean(&|k| error[k] * places[k].y.powi(power)).abs() < 1e-9);
        }
    }
}

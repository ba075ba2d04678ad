//! Repeated readings on the home reference platform.

use super::home_platform::{HomeFix, HomePlatformError, locate_platform};
use crate::geometry::{Pose, Twist};
use crate::robot::{HomePlatform, HomeSensor};

/// Measuring range of the GP2Y0A41SK0F of Jin et al. 2018 (m), from its data sheet.
const INFRARED_RANGE_M: std::ops::RangeInclusive<f64> = 0.04..=0.3;

/// Statistics of the repeated readings of one sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SensorRepeats {
    /// Number of readings.
    pub count: usize,
    /// Mean distance (m).
    pub mean_m: f64,
    /// Standard deviation of a reading about the mean (m); NaN for a single reading.
    pub sd_m: f64,
    /// Standard error of the mean, `sd / sqrt(count)` (m); NaN for a single reading.
    pub standard_error_m: f64,
    /// Whether the mean lies in the measuring range of the infrared sensor; true for sensors that give metres.
    pub in_range: bool,
}

/// Home pose from repeated readings.
#[derive(Debug, Clone, PartialEq)]
pub struct HomeMeasurement {
    /// Pose from the mean distances. Its covariance assumes independent readings of a sensor, each with the
    /// stated `sd_m`, hence `sd_m / sqrt(count)` for the mean.
    pub fix: HomeFix,
    /// Statistics of each sensor.
    pub sensors: Vec<SensorRepeats>,
    /// Standard deviation of the pose from one reading of each sensor, about the mean pose, in the base
    /// frame `[x y z, phi_x phi_y phi_z]` (m, rad): the repeatability. `None` unless all sensors
    /// have the same number of readings, at least two, taken cycle by cycle.
    pub repeatability: Option<[f64; 6]>,
}

/// Computes the home pose from `readings[sensor]`, volts where the sensor has a curve, else metres.
///
/// # Errors
/// As [`locate_platform`]; also if a sensor has no reading, or one beyond the pole of its
/// curve.
pub fn measure_home(
    home: &HomePlatform,
    readings: &[Vec<f64>],
    start_in_reference: &Pose,
) -> Result<HomeMeasurement, HomePlatformError> {
    if readings.len() != home.sensors.len() {
        let given = readings.len();
        return Err(HomePlatformError::NotSix { given });
    }
    let mut distances = Vec::with_capacity(readings.len());
    for (index, (sensor, readings)) in home.sensors.iter().zip(readings).enumerate() {
        distances.push(to_distances(index, sensor, readings)?);
    }
    let repeats = home.sensors.iter().zip(&distances);
    let sensors: Vec<SensorRepeats> = repeats.map(|(s, d)| summarise(s, d)).collect();
    let means: Vec<f64> = sensors.iter().map(|s| s.mean_m).collect();
    let sds = home.sensors.iter().zip(&sensors);
    let sds: Vec<f64> = sds
        .map(|(sensor, repeats)| sensor.sd_m / (repeats.count as f64).sqrt())
        .collect();
    let fix = locate_platform(home, &means, &sds, start_in_reference)?;
    let repeatability = repeatability(home, &distances, &fix)?;
    Ok(HomeMeasurement {
        fix,
        sensors,
        repeatability,
    })
}

fn to_distances(
    index: usize,
    sensor: &HomeSensor,
    readings: &[f64],
) -> Result<Vec<f64>, HomePlatformError> {
    let at_sensor = |message: String| HomePlatformError::Sensor {
        sensor: index + 1,
        message,
    };
    if readings.is_empty() {
        return Err(at_sensor("it has no reading".to_owned()));
    }
    let to_distance = |reading: &f64| match &sensor.curve {
        Some(curve) => curve.distance_m(*reading).ok_or_else(|| {
            at_sensor(format!(
                "{reading} V is outside the range of its voltage curve"
            ))
        }),
        None => Ok(*reading),
    };
    readings.iter().map(to_distance).collect()
}

fn summarise(sensor: &HomeSensor, distances: &[f64]) -> SensorRepeats {
    let count = distances.len();
    let mean_m = distances.iter().sum::<f64>() / count as f64;
    let square: f64 = distances.iter().map(|d| (d - mean_m).powi(2)).sum();
    // NaN (0/0) for a single reading, whose spread is unknown.
    let sd_m = (square / (count as f64 - 1.0)).sqrt();
    SensorRepeats {
        count,
        mean_m,
        sd_m,
        standard_error_m: sd_m / (count as f64).sqrt(),
        in_range: sensor.curve.is_none() || INFRARED_RANGE_M.contains(&mean_m),
    }
}

fn repeatability(
    home: &HomePlatform,
    distances: &[Vec<f64>],
    fix: &HomeFix,
) -> Result<Option<[f64; 6]>, HomePlatformError> {
    let cycles = distances[0].len();
    if cycles < 2 || distances.iter().any(|d| d.len() != cycles) {
        return Ok(None);
    }
    let mut deviations = Vec::with_capacity(cycles);
    for cycle in 0..cycles {
        let once: Vec<f64> = distances.iter().map(|d| d[cycle]).collect();
        let pose = locate_platform(home, &once, &[0.0; 6], &fix.platform_in_reference)?;
        deviations.push(pose.platform_in_base.difference(&fix.platform_in_base));
    }
    let mean = deviations.iter().sum::<Twist>() / cycles as f64;
    let squares = deviations
        .iter()
        .map(|d| (d - mean).component_mul(&(d - mean)));
    let variance = squares.sum::<Twist>() / (cycles as f64 - 1.0);
    Ok(Some(variance.map(f64::sqrt).into()))
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    use super::super::home_platform::tests::{arrangement, distances, truth};
    use super::*;
    use crate::robot::DistanceCurve;

    #[test]
    fn repeatability_is_the_spread_that_the_covariance_predicts() {
        // 400 cycles: the sd of a sd is 3.5 %; 5 sd for six components, false failure below 4e-6.
        let home = arrangement();
        let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(11);
        let readings: Vec<Vec<f64>> = distances(&home, &truth())
            .iter()
            .map(|d| {
                let mut noise = || -> f64 { StandardNormal.sample(&mut random) };
                (0..400).map(|_| d + 2e-4 * noise()).collect()
            })
            .collect();
        let result = measure_home(&home, &readings, &Pose::identity()).unwrap();
        let spread = result.repeatability.unwrap();
        for k in 0..6 {
            let of_one = (400.0 * result.fix.covariance_in_base[(k, k)]).sqrt();
            assert!((spread[k] / of_one - 1.0).abs() < 0.18, "{k}");
        }
        assert!((result.sensors[0].standard_error_m - 1e-5).abs() < 2e-6);
    }

    #[test]
    fn volts_become_distances() {
        let mut home = arrangement();
        let curve = DistanceCurve {
            a: 8.6,
            b: -0.2,
            c: 0.002,
        };
        let mut readings = Vec::new();
        for (sensor, d) in home
            .sensors
            .iter_mut()
            .zip(distances(&arrangement(), &truth()))
        {
            sensor.curve = Some(curve);
            readings.push(vec![(1.0 / (d - curve.c) - curve.b) / curve.a]);
        }
        let result = measure_home(&home, &readings, &Pose::identity()).unwrap();
        let error = result.fix.platform_in_reference.difference(&truth());
        assert!(error.norm() < 1e-11);
        assert!(result.repeatability.is_none() && result.sensors[0].sd_m.is_nan());
        assert!(result.sensors.iter().all(|s| s.in_range));
        readings[1] = vec![0.01];
        let error = measure_home(&home, &readings, &Pose::identity()).unwrap_err();
        assert!(error.to_string().starts_with("sensor 2: 0.01 V"));
    }
}

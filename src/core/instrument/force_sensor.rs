//! Force sensor calibration: gain and bias from known weights.

use super::calibration_error::{CalibrationError, check_pairs};
use crate::fitting::fit_line;

/// Largest residual of an acceptable force sensor, as a load (N): Jin et al. 2018, section 3.2.
pub const FORCE_RESIDUAL_LIMIT_N: f64 = 1.0;

/// One calibration reading of a force sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ForcePair {
    /// Raw reading (N).
    pub reading_n: f64,
    /// Known load in the cable (N).
    pub load_n: f64,
}

/// Result of a force sensor calibration.
///
/// `reading = g load + f0` (Jin et al. 2018, section 3.2, with a bias; g = 2 because of the deflection
/// pulley). The loads are assumed exact, the readings to have equal, independent errors. Residuals
/// are given as loads: `(reading - f0) / g - load`.
#[derive(Debug, Clone, PartialEq)]
pub struct ForceSensorCalibration {
    /// Gain `g`, reading per load.
    pub gain: f64,
    /// Its standard deviation.
    pub gain_sd: f64,
    /// Bias `f0`, reading without load (N).
    pub bias_n: f64,
    /// Its standard deviation (N).
    pub bias_sd_n: f64,
    /// Measured minus known load of each pair (N).
    pub residuals_n: Vec<f64>,
    /// Standard deviation of a measured load (N).
    pub residual_sd_n: f64,
    /// Largest absolute residual (N).
    pub largest_residual_n: f64,
    /// Degrees of freedom.
    pub dof: usize,
    /// Whether the largest residual is below [`FORCE_RESIDUAL_LIMIT_N`].
    pub passed: bool,
}

/// Fits gain and bias.
///
/// # Errors
/// Fewer than three pairs, values that are not finite, one load only, or readings that do not
/// follow the load.
pub fn calibrate_force_sensor(
    pairs: &[ForcePair],
) -> Result<ForceSensorCalibration, CalibrationError> {
    let values = pairs.iter().map(|p| [p.reading_n, p.load_n]);
    check_pairs(values, "gain and bias", 3)?;
    let loads: Vec<f64> = pairs.iter().map(|p| p.load_n).collect();
    let readings: Vec<f64> = pairs.iter().map(|p| p.reading_n).collect();
    let fit = fit_line(&loads, &readings, None);
    if !fit.is_full_rank() {
        let message = "all readings have the same load: hang different weights";
        return Err(CalibrationError::Degenerate(message.to_owned()));
    }
    let (bias_n, gain) = (fit.parameters[0], fit.parameters[1]);
    let span = readings
        .iter()
        .fold(0.0_f64, |most, r| most.max((r - readings[0]).abs()));
    if span == 0.0 || gain == 0.0 {
        let message = "the reading does not change with the load: check the sensor and its wiring";
        return Err(CalibrationError::Degenerate(message.to_owned()));
    }
    let largest_residual_n = fit.largest_residual() / gain.abs();
    Ok(ForceSensorCalibration {
        gain,
        gain_sd: fit.standard_deviations[1],
        bias_n,
        bias_sd_n: fit.standard_deviations[0],
        residuals_n: fit.residuals.iter().map(|e| e / gain).collect(),
        residual_sd_n: fit.residual_sd / gain.abs(),
        largest_residual_n,
        dof: fit.dof,
        passed: largest_residual_n < FORCE_RESIDUAL_LIMIT_N,
    })
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_distr::{Distribution, Normal};

    use super::*;

    fn pairs(noise_n: f64, seed: u64) -> Vec<ForcePair> {
        let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
        let normal = Normal::new(0.0, noise_n).unwrap();
        let pair = |i: i32| ForcePair {
            load_n: 10.0 * f64::from(i),
            reading_n: 20.4 * f64::from(i) - 1.5 + normal.sample(&mut random),
        };
        (0..7).map(pair).collect()
    }

    #[test]
    fn exact_pairs_give_the_exact_sensor() {
        let result = calibrate_force_sensor(&pairs(0.0, 1)).unwrap();
        assert!((result.gain - 2.04).abs() < 1e-14 && (result.bias_n + 1.5).abs() < 1e-13);
        assert!(result.passed);
    }

    #[test]
    fn residuals_are_loads() {
        let mut pairs = pairs(0.0, 1);
        pairs[3].reading_n += 2.04 * 1.4;
        let result = calibrate_force_sensor(&pairs).unwrap();
        // The middle of seven readings keeps 6/7 of its error.
        assert!((result.largest_residual_n - 1.2).abs() < 1e-12);
        assert!(result.residuals_n[3] > 0.0 && !result.passed);
    }

    #[test]
    fn standard_deviations_cover() {
        // 95 % of Student's t with 5 degrees of freedom; two-sided 5 sd of the binomial count: a
        // false failure has probability 6e-7 per parameter (the seeds are fixed).
        let mut covered = [0; 2];
        for seed in 0..2000 {
            let result = calibrate_force_sensor(&pairs(0.8, seed)).unwrap();
            let limit = 2.570_582;
            covered[0] += usize::from((result.gain - 2.04).abs() < limit * result.gain_sd);
            covered[1] += usize::from((result.bias_n + 1.5).abs() < limit * result.bias_sd_n);
        }
        for count in covered {
            assert!(
                (f64::from(count as u32) - 1900.0).abs() < 5.0 * 9.75,
                "{count}"
            );
        }
    }

    #[test]
    fn unusable_pairs_are_refused_in_words() {
        let same_load = [ForcePair {
            reading_n: 20.0,
            load_n: 10.0,
        }; 4];
        let message = calibrate_force_sensor(&same_load).unwrap_err().to_string();
        assert!(message.contains("different weights"));
        let dead = [0.0, 10.0, 20.0].map(|load_n| ForcePair {
            reading_n: 5.0,
            load_n,
        });
        let message = calibrate_force_sensor(&dead).unwrap_err().to_string();
        assert!(message.contains("does not change with the load"));
    }
}

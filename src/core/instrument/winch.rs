//! Winch calibration: cable per motor revolution.

use nalgebra::DMatrix;

use super::calibration_error::{CalibrationError, check_pairs};
use crate::fitting::{FitStatistics, fit_linear};

/// Largest residual of an acceptable winch (m): Jin et al. 2018, section 3.1, report less than 0.1 mm
/// without payload.
pub const WINCH_RESIDUAL_LIMIT_M: f64 = 1e-4;

/// Tensions whose range is below this fraction of their mean do not determine the stretch.
const MIN_TENSION_RANGE: f64 = 0.1;

/// One calibration reading of a winch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WinchPair {
    /// Motor revolutions; positive pays cable out.
    pub revolutions: f64,
    /// Measured cable length, from any fixed datum (m).
    pub length_m: f64,
    /// Cable tension during the reading (N), if measured.
    pub tension_n: Option<f64>,
}

/// Result of a winch calibration.
///
/// `length = k rev + offset + e tension` (equation 1 of Jin et al. 2018 with a datum): `k` in metres
/// of cable per motor revolution, `e` the stretch per newton at the mean length, which is fitted only if
/// every reading has a tension and the tensions vary by more than a tenth of their mean. Otherwise
/// `k` and the offset include the stretch at constant tension. Lengths are assumed to have equal,
/// independent errors, revolutions to be exact.
#[derive(Debug, Clone, PartialEq)]
pub struct WinchCalibration {
    /// Cable per motor revolution `k` (m).
    pub cable_per_revolution_m: f64,
    /// Its standard deviation (m).
    pub cable_per_revolution_sd_m: f64,
    /// Length at zero revolutions (and zero tension if the stretch is fitted) (m).
    pub offset_m: f64,
    /// Its standard deviation (m).
    pub offset_sd_m: f64,
    /// Stretch per newton `e` and its standard deviation (m/N), where fitted.
    pub stretch_m_per_n: Option<(f64, f64)>,
    /// Measured minus fitted length of each pair (m).
    pub residuals_m: Vec<f64>,
    /// Standard deviation of a length reading (m).
    pub residual_sd_m: f64,
    /// Largest absolute residual (m).
    pub largest_residual_m: f64,
    /// Degrees of freedom.
    pub dof: usize,
    /// Whether the largest residual is below [`WINCH_RESIDUAL_LIMIT_M`].
    pub passed: bool,
}

/// Fits cable per revolution, offset and, where the tensions vary, stretch.
///
/// # Errors
/// Fewer than three pairs, values that are not finite, or all readings at one revolution.
pub fn calibrate_winch(pairs: &[WinchPair]) -> Result<WinchCalibration, CalibrationError> {
    let values = pairs
        .iter()
        .map(|p| [p.revolutions, p.length_m, p.tension_n.unwrap_or(0.0)]);
    check_pairs(values, "cable per revolution and offset", 3)?;
    if let Some(tensions) = varying_tensions(pairs) {
        let fit = fit(pairs, Some(&tensions));
        if fit.is_full_rank() {
            return Ok(summary(fit, true));
        }
    }
    let fit = fit(pairs, None);
    if !fit.is_full_rank() {
        return Err(CalibrationError::Degenerate(
            "all readings are at the same motor revolution: turn the winch between readings"
                .to_owned(),
        ));
    }
    Ok(summary(fit, false))
}

/// The tensions, if all were measured and vary, and a fourth pair gives redundancy.
fn varying_tensions(pairs: &[WinchPair]) -> Option<Vec<f64>> {
    let tensions: Vec<f64> = pairs.iter().map(|p| p.tension_n).collect::<Option<_>>()?;
    let highest = tensions.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let lowest = tensions.iter().copied().fold(f64::INFINITY, f64::min);
    let varies = highest - lowest > MIN_TENSION_RANGE * 0.5 * (highest + lowest).abs();
    (varies && pairs.len() > 3).then_some(tensions)
}

fn fit(pairs: &[WinchPair], tensions: Option<&[f64]>) -> FitStatistics {
    let columns = if tensions.is_some() { 3 } else { 2 };
    let design = DMatrix::from_fn(pairs.len(), columns, |i, k| match (k, tensions) {
        (0, _) => pairs[i].revolutions,
        (2, Some(tensions)) => tensions[i],
        _ => 1.0,
    });
    let lengths: Vec<f64> = pairs.iter().map(|p| p.length_m).collect();
    fit_linear(&design, &lengths, None)
}

fn summary(fit: FitStatistics, with_stretch: bool) -> WinchCalibration {
    let estimate = |k: usize| (fit.parameters[k], fit.standard_deviations[k]);
    let (cable_per_revolution_m, cable_per_revolution_sd_m) = estimate(0);
    let (offset_m, offset_sd_m) = estimate(1);
    let largest_residual_m = fit.largest_residual();
    WinchCalibration {
        cable_per_revolution_m,
        cable_per_revolution_sd_m,
        offset_m,
        offset_sd_m,
        stretch_m_per_n: with_stretch.then(|| estimate(2)),
        residual_sd_m: fit.residual_sd,
        largest_residual_m,
        dof: fit.dof,
        passed: largest_residual_m < WINCH_RESIDUAL_LIMIT_M,
        residuals_m: fit.residuals,
    }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_distr::{Distribution, Normal};

    use super::*;

    fn pairs(noise_m: f64, seed: u64) -> Vec<WinchPair> {
        let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
        let normal = Normal::new(0.0, noise_m).unwrap();
        let pair = |i: i32| WinchPair {
            revolutions: f64::from(i),
            length_m: 0.126 * f64::from(i) + 0.35 + normal.sample(&mut random),
            tension_n: None,
        };
        (0..8).map(pair).collect()
    }

    #[test]
    fn exact_pairs_give_the_exact_winch() {
        let result = calibrate_winch(&pairs(0.0, 1)).unwrap();
        assert!((result.cable_per_revolution_m - 0.126).abs() < 1e-15);
        assert!((result.offset_m - 0.35).abs() < 1e-15);
        assert!(result.passed && result.stretch_m_per_n.is_none());
    }

    #[test]
    fn varying_tension_separates_the_stretch() {
        let mut pairs = pairs(0.0, 1);
        for (i, pair) in pairs.iter_mut().enumerate() {
            let tension = if i % 3 == 0 { 10.0 } else { 60.0 };
            pair.tension_n = Some(tension);
            pair.length_m += 2e-5 * tension;
        }
        let result = calibrate_winch(&pairs).unwrap();
        assert!((result.cable_per_revolution_m - 0.126).abs() < 1e-14);
        assert!((result.stretch_m_per_n.unwrap().0 - 2e-5).abs() < 1e-15);
    }

    #[test]
    fn standard_deviations_cover() {
        // 95 % intervals of Student's t with 6 degrees of freedom. Coverage of k in 2000 trials is binomial
        // with sd 0.49 %; 5 sd: a false failure has probability 6e-7 (the seeds are fixed).
        let covered = (0..2000)
            .filter(|seed| {
                let result = calibrate_winch(&pairs(3e-5, *seed)).unwrap();
                let error = result.cable_per_revolution_m - 0.126;
                error.abs() < 2.446_912 * result.cable_per_revolution_sd_m
            })
            .count();
        assert!((covered as f64 - 1900.0).abs() < 5.0 * 9.75, "{covered}");
    }

    #[test]
    fn a_residual_above_the_limit_fails() {
        let mut pairs = pairs(0.0, 1);
        pairs[4].length_m += 3e-4;
        let result = calibrate_winch(&pairs).unwrap();
        assert!(!result.passed && result.largest_residual_m > 2e-4);
    }

    #[test]
    fn unusable_pairs_are_refused_in_words() {
        let mut pairs = pairs(0.0, 1);
        let few = calibrate_winch(&pairs[..2]).unwrap_err().to_string();
        assert!(few.starts_with("2 pairs are too few: 3 are needed"));
        pairs[3].length_m = f64::NAN;
        let invalid = calibrate_winch(&pairs).unwrap_err().to_string();
        assert!(invalid.starts_with("pair 4 "));
        let still = [pairs[1]; 4];
        let degenerate = calibrate_winch(&still).unwrap_err().to_string();
        assert!(degenerate.contains("same motor revolution"));
    }
}

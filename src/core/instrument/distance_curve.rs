//! Voltage curve of an infrared distance sensor.

use nalgebra::DMatrix;

use super::calibration_error::{CalibrationError, check_pairs};
use crate::fitting::{CurveFitOptions, CurveProblem, FitStatistics, fit_curve, fit_line};
use crate::robot::DistanceCurve;

impl DistanceCurve {
    /// Distance (m) at a voltage (V): `d = 1 / (a v + b) + c`.
    ///
    /// `None` at and beyond the pole `a v + b = 0`, where the curve is not defined.
    #[must_use]
    pub fn distance_m(&self, voltage_v: f64) -> Option<f64> {
        let inverse = self.a * voltage_v + self.b;
        let distance = 1.0 / inverse + self.c;
        (inverse > 0.0 && distance.is_finite()).then_some(distance)
    }

    /// Slope of the distance over the voltage (m/V): `-a / (a v + b)^2`.
    #[must_use]
    pub fn slope_m_per_v(&self, voltage_v: f64) -> f64 {
        -self.a / (self.a * voltage_v + self.b).powi(2)
    }
}

/// One calibration reading of a distance sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DistancePair {
    /// Sensor voltage (V).
    pub voltage_v: f64,
    /// Known distance (m).
    pub distance_m: f64,
}

/// A fitted voltage curve `d = 1 / (a v + b) + c` for triangulating sensors such as the
/// GP2Y0A41SK0F, whose voltage falls with the distance (m, V). Distances are assumed to have equal,
/// independent errors, which include the noise of the voltage.
#[derive(Debug, Clone, PartialEq)]
pub struct DistanceCurveFit {
    /// The curve.
    pub curve: DistanceCurve,
    /// Standard deviations of `a`, `b` and `c`.
    pub sd: DistanceCurve,
    /// Known minus fitted distance of each pair (m).
    pub residuals_m: Vec<f64>,
    /// Standard deviation of a measured distance (m).
    pub residual_sd_m: f64,
    /// Largest absolute residual (m).
    pub largest_residual_m: f64,
    /// Degrees of freedom.
    pub dof: usize,
    /// Whether the fit converged.
    pub converged: bool,
}

/// Fits the curve by nonlinear least squares.
///
/// It starts from the line `1/d = a v + b` through the inverse distances, which is the curve with `c = 0`.
///
/// # Errors
/// Fewer than four pairs, values that are not finite, distances that are not positive, fewer than
/// three different voltages, or readings that do not follow such a curve.
pub fn fit_distance_curve(pairs: &[DistancePair]) -> Result<DistanceCurveFit, CalibrationError> {
    let values = pairs.iter().map(|p| [p.voltage_v, p.distance_m]);
    check_pairs(values, "the three numbers of the voltage curve", 4)?;
    let degenerate = |message: &str| Err(CalibrationError::Degenerate(message.to_owned()));
    if pairs.iter().any(|p| p.distance_m <= 0.0) {
        return degenerate("a distance is not positive");
    }
    let voltages: Vec<f64> = pairs.iter().map(|p| p.voltage_v).collect();
    let distances: Vec<f64> = pairs.iter().map(|p| p.distance_m).collect();
    let inverse: Vec<f64> = distances.iter().map(|d| 1.0 / d).collect();
    // Errors of 1/d grow with 1/d^2.
    let inverse_sd: Vec<f64> = inverse.iter().map(|i| i * i).collect();
    let line = fit_line(&voltages, &inverse, Some(&inverse_sd));
    let mut different = voltages.clone();
    different.sort_by(f64::total_cmp);
    different.dedup();
    if different.len() < 3 || !line.is_full_rank() {
        return degenerate(
            "at least three different voltages are needed to determine the curvature",
        );
    }
    let start = [line.parameters[1], line.parameters[0], 0.0];
    let (fit, converged) = fit(&voltages, &distances, start);
    let curve = curve_of(&fit.parameters);
    let is_defined = voltages.iter().all(|v| curve.distance_m(*v).is_some());
    if !fit.is_full_rank() || !is_defined {
        return degenerate(
            "the readings do not follow 1/(a v + b) + c: check that voltage and distance are not swapped",
        );
    }
    Ok(DistanceCurveFit {
        curve,
        sd: curve_of(&fit.standard_deviations),
        residual_sd_m: fit.residual_sd,
        largest_residual_m: fit.largest_residual(),
        dof: fit.dof,
        residuals_m: fit.residuals,
        converged,
    })
}

fn curve_of(values: &[f64]) -> DistanceCurve {
    DistanceCurve {
        a: values[0],
        b: values[1],
        c: values[2],
    }
}

fn fit(voltages: &[f64], distances: &[f64], start: [f64; 3]) -> (FitStatistics, bool) {
    let predict = |p: &[f64], d: &mut [f64]| {
        let curve = curve_of(p);
        for (d, v) in d.iter_mut().zip(voltages) {
            *d = curve.distance_m(*v).unwrap_or(f64::NAN);
        }
    };
    let differentiate = |p: &[f64], jacobian: &mut DMatrix<f64>| {
        for (mut row, v) in jacobian.row_iter_mut().zip(voltages) {
            let inverse = p[0] * v + p[1];
            row[0] = -v / (inverse * inverse);
            row[1] = -1.0 / (inverse * inverse);
            row[2] = 1.0;
        }
    };
    let problem = CurveProblem {
        observations: distances,
        sd: None,
        predict: &predict,
        jacobian: Some(&differentiate),
    };
    let fit = fit_curve(&problem, &start, &CurveFitOptions::default());
    (fit.statistics, fit.converged)
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_distr::{Distribution, Normal};

    use super::*;

    /// Roughly the data sheet of the GP2Y0A41SK0F: 3 V at 40 mm, 0.4 V at 300 mm.
    const TRUTH: DistanceCurve = DistanceCurve {
        a: 8.6,
        b: -0.2,
        c: 0.002,
    };

    fn pairs(noise_m: f64, seed: u64) -> Vec<DistancePair> {
        let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
        let normal = Normal::new(0.0, noise_m).unwrap();
        let pair = |i: i32| {
            let voltage_v = 0.4 + 0.2 * f64::from(i);
            let noise = normal.sample(&mut random);
            let distance_m = TRUTH.distance_m(voltage_v).unwrap() + noise;
            DistancePair {
                voltage_v,
                distance_m,
            }
        };
        (0..14).map(pair).collect()
    }

    #[test]
    fn exact_pairs_give_the_exact_curve() {
        let fit = fit_distance_curve(&pairs(0.0, 1)).unwrap();
        assert!(fit.converged && fit.largest_residual_m < 1e-15);
        assert!((fit.curve.a - TRUTH.a).abs() < 1e-10);
        assert!((fit.curve.c - TRUTH.c).abs() < 1e-12);
    }

    #[test]
    fn slope_matches_a_difference() {
        let h = 1e-6;
        let at = |v: f64| TRUTH.distance_m(v).unwrap();
        let slope = (at(1.0 + h) - at(1.0 - h)) / (2.0 * h);
        assert!((slope - TRUTH.slope_m_per_v(1.0)).abs() < 1e-9);
        assert!(TRUTH.distance_m(0.01).is_none(), "beyond the pole");
    }

    #[test]
    fn standard_deviations_cover() {
        // 95 % of Student's t with 11 degrees of freedom; the curve is nearly linear in its
        // parameters at this noise. 5 sd of the binomial count: false failure below 1e-5 for the three.
        let mut covered = [0_u32; 3];
        for seed in 0..2000 {
            let fit = fit_distance_curve(&pairs(2e-4, seed)).unwrap();
            let [a, b, c] = [
                (fit.curve.a - TRUTH.a) / fit.sd.a,
                (fit.curve.b - TRUTH.b) / fit.sd.b,
                (fit.curve.c - TRUTH.c) / fit.sd.c,
            ];
            for (count, ratio) in covered.iter_mut().zip([a, b, c]) {
                *count += u32::from(ratio.abs() < 2.200_985);
            }
        }
        for count in covered {
            assert!(
                (f64::from(count) - 1900.0).abs() < 5.0 * 9.75,
                "{covered:?}"
            );
        }
    }

    #[test]
    fn unusable_pairs_are_refused_in_words() {
        let one = DistancePair {
            voltage_v: 1.0,
            distance_m: 0.1,
        };
        let message = fit_distance_curve(&[one; 5]).unwrap_err().to_string();
        assert!(message.contains("three different voltages"));
    }
}

//! Weighted mean of several measurements of the home pose.

use nalgebra::{Cholesky, Matrix6};

use crate::geometry::{Pose, Twist};
use crate::statistics::chi_square_survival;

/// Largest number of Gauss-Newton steps; poses of one home differ by millimetres, so that two suffice.
const MOST_STEPS: usize = 20;
/// Step below which the mean has converged (m, rad).
const SETTLED: f64 = 1e-13;

/// One measurement of the home pose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HomeReading {
    /// The pose, base frame.
    pub pose: Pose,
    /// Covariance of its error as a [`Twist`] in the base frame (m, rad).
    pub covariance: Matrix6<f64>,
}

impl HomeReading {
    /// A pose with the same standard deviation along each axis (m) and about each axis (rad).
    #[must_use]
    pub fn isotropic(pose: Pose, position_sd_m: f64, orientation_sd_rad: f64) -> Self {
        let sd = |k: usize| {
            if k < 3 {
                position_sd_m
            } else {
                orientation_sd_rad
            }
        };
        Self {
            pose,
            covariance: Matrix6::from_diagonal(&Twist::from_fn(|k, _| sd(k).powi(2))),
        }
    }
}

/// The weighted mean of measurements of the home pose.
///
/// The mean `x` minimises `sum d_k^T C_k^-1 d_k` with the small motion `d_k` from `x` to measurement `k` of the covariance
/// `C_k`; its covariance is `(sum C_k^-1)^-1`. Errors are assumed independent. No repetition removes an error that all
/// measurements share, such as that of the reference frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HomeAverage {
    /// The mean, base frame.
    pub pose: Pose,
    /// Its covariance as a [`Twist`] in the base frame (m, rad).
    pub covariance: Matrix6<f64>,
    /// Number of measurements.
    pub count: usize,
    /// `sum d_k^T C_k^-1 d_k` at the mean: chi-square with `6 (count - 1)` degrees of freedom if the covariances are right.
    pub chi2: f64,
}

impl HomeAverage {
    /// Averages measurements; `None` if there are none, or if a covariance is not positive definite.
    #[must_use]
    pub fn of(readings: &[HomeReading]) -> Option<Self> {
        let weights: Option<Vec<Matrix6<f64>>> = readings
            .iter()
            .map(|reading| Cholesky::new(reading.covariance).map(|factor| factor.inverse()))
            .collect();
        let weights = weights?;
        let covariance = Cholesky::new(weights.iter().sum::<Matrix6<f64>>())?.inverse();
        let mut pose = readings.first()?.pose;
        let deviations = |pose: &Pose| -> Vec<Twist> {
            let deviation = |reading: &HomeReading| reading.pose.difference(pose);
            readings.iter().map(deviation).collect()
        };
        for _ in 0..MOST_STEPS {
            let found = deviations(&pose);
            let pull: Twist = weights.iter().zip(&found).map(|(w, d)| w * d).sum();
            let step = covariance * pull;
            pose = pose.perturbed(&step);
            if step.amax() < SETTLED {
                break;
            }
        }
        let found = deviations(&pose);
        let squares = weights.iter().zip(&found).map(|(w, d)| d.dot(&(w * d)));
        Some(Self {
            pose,
            covariance,
            count: readings.len(),
            chi2: squares.sum(),
        })
    }

    /// Standard deviations of the position (m) and of the rotation vector (rad), base frame.
    #[must_use]
    pub fn sd(&self) -> ([f64; 3], [f64; 3]) {
        let sd = |k: usize| self.covariance[(k, k)].sqrt();
        ([0, 1, 2].map(sd), [3, 4, 5].map(sd))
    }

    /// Probability of differences at least as large if the covariances are right; `None` for a single measurement.
    #[must_use]
    pub fn p_value(&self) -> Option<f64> {
        let freedom = 6 * self.count.checked_sub(1)?;
        chi_square_survival(self.chi2, freedom as f64)
    }
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_distr::StandardNormal;

    use super::*;

    fn covariance() -> Matrix6<f64> {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(5);
        let size = |k: usize| if k < 3 { 1e-4 } else { 5e-4 };
        let factor = Matrix6::from_fn(|i, _| size(i) * rng.sample::<f64, _>(StandardNormal));
        factor * factor.transpose() + Matrix6::from_diagonal_element(1e-12)
    }

    #[test]
    fn equal_measurements_divide_the_covariance_by_their_number() {
        let truth = Pose::from_parts([0.1, -0.2, 0.3], [0.9, 0.1, -0.2, 0.3]);
        let covariance = covariance();
        let factor = covariance.cholesky().unwrap().l();
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(6);
        let mut sums = [0.0; 2];
        const TRIALS: usize = 500;
        for _ in 0..TRIALS {
            let readings: Vec<HomeReading> = (0..4)
                .map(|_| HomeReading {
                    pose: truth
                        .perturbed(&(factor * Twist::from_fn(|_, _| rng.sample(StandardNormal)))),
                    covariance,
                })
                .collect();
            let mean = HomeAverage::of(&readings).unwrap();
            assert!((mean.covariance * 4.0 - covariance).amax() < 1e-9 * covariance.amax());
            let off = mean.pose.difference(&truth);
            sums[0] += off.dot(&(mean.covariance.try_inverse().unwrap() * off));
            sums[1] += mean.chi2;
        }
        // Means of chi-squares with 6 and 18 degrees of freedom: 5 standard deviations, a false failure below 6e-7 each.
        let n = TRIALS as f64;
        assert!(
            (sums[0] / n - 6.0).abs() < 5.0 * (12.0 / n).sqrt(),
            "{sums:?}"
        );
        assert!(
            (sums[1] / n - 18.0).abs() < 5.0 * (36.0 / n).sqrt(),
            "{sums:?}"
        );
    }

    #[test]
    fn a_measurement_counts_by_what_it_knows() {
        let at = |x: f64| Pose::from_parts([x, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0]);
        let mean = HomeAverage::of(&[
            HomeReading::isotropic(at(0.0), 1e-4, 1e-3),
            HomeReading::isotropic(at(5e-4), 2e-4, 1e-3),
        ])
        .unwrap();
        // Weights 4 to 1.
        assert!((mean.pose.position.x - 1e-4).abs() < 1e-15);
        assert!((mean.sd().0[0] - 1e-4 * (0.8_f64).sqrt()).abs() < 1e-15);
        assert!((mean.chi2 - (1.0 + 4.0)).abs() < 1e-9);
        // 5.0 at 6 degrees of freedom, by the closed form exp(-x/2) (1 + x/2 + x^2/8).
        let expected = (-2.5_f64).exp() * (1.0 + 2.5 + 25.0 / 8.0);
        assert!((mean.p_value().unwrap() - expected).abs() < 1e-9);
        let alone = HomeReading::isotropic(at(0.0), 1e-4, 1e-3);
        assert_eq!(HomeAverage::of(&[alone]).unwrap().p_value(), None);
        assert_eq!(HomeAverage::of(&[]), None);
        let exact = HomeReading::isotropic(at(0.0), 0.0, 1e-3);
        assert_eq!(HomeAverage::of(&[exact]), None);
    }
}

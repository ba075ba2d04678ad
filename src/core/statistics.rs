//! Probability distributions for tests and intervals.

use nalgebra::{DMatrix, SymmetricEigen};
use statrs::distribution::{ChiSquared, ContinuousCDF, FisherSnedecor, Normal, StudentsT};

/// Logarithm of the sum of numbers given by their logarithms; minus infinity for none.
pub(crate) fn log_sum(values: impl Iterator<Item = f64>) -> f64 {
    let values: Vec<f64> = values.collect();
    let largest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if largest == f64::NEG_INFINITY {
        return largest;
    }
    largest + values.iter().map(|v| (v - largest).exp()).sum::<f64>().ln()
}

/// Log odds of a probability.
pub(crate) fn logit(probability: f64) -> f64 {
    (probability / (1.0 - probability)).ln()
}

/// Probability that a chi-square variable exceeds `value`; `None` without degrees of freedom.
#[must_use]
pub fn chi_square_survival(value: f64, degrees_of_freedom: f64) -> Option<f64> {
    let distribution = ChiSquared::new(degrees_of_freedom).ok()?;
    Some(distribution.sf(value.max(0.0)))
}

/// Twice the smaller tail probability of a chi-square variable at `value`, at most 1; `None` without
/// degrees of freedom.
#[must_use]
pub fn chi_square_two_sided(value: f64, degrees_of_freedom: f64) -> Option<f64> {
    let distribution = ChiSquared::new(degrees_of_freedom).ok()?;
    let value = value.max(0.0);
    let tail = distribution.sf(value).min(distribution.cdf(value));
    Some((2.0 * tail).min(1.0))
}

/// Chi-square quantile: the value that is exceeded with probability `1 - probability`, for `probability` from 0 to 1;
/// `None` without degrees of freedom.
#[must_use]
pub fn chi_square_quantile(probability: f64, degrees_of_freedom: f64) -> Option<f64> {
    let distribution = ChiSquared::new(degrees_of_freedom).ok()?;
    Some(distribution.inverse_cdf(probability.clamp(0.0, 1.0)))
}

/// Quantile of Student's t distribution; the normal quantile for infinitely many degrees of freedom, `None` without any.
#[must_use]
pub fn student_t_quantile(probability: f64, degrees_of_freedom: f64) -> Option<f64> {
    if degrees_of_freedom.is_infinite() {
        return Some(normal_quantile(probability));
    }
    let distribution = StudentsT::new(0.0, 1.0, degrees_of_freedom).ok()?;
    Some(distribution.inverse_cdf(probability))
}

/// Probability that the ratio of two independent mean squares exceeds `value`, with `[numerator, denominator]`
/// degrees of freedom (Fisher's F); `None` if either has none.
#[must_use]
pub fn f_survival(value: f64, degrees_of_freedom: [f64; 2]) -> Option<f64> {
    let [numerator, denominator] = degrees_of_freedom;
    let distribution = FisherSnedecor::new(numerator, denominator).ok()?;
    Some(distribution.sf(value.max(0.0)))
}

/// Two-sided probability that a standard normal variable is at least `size` away from zero.
#[must_use]
pub fn normal_two_sided(size: f64) -> f64 {
    2.0 * Normal::standard().sf(size.abs())
}

/// Probability that a standard normal variable is below `value`.
#[must_use]
pub fn normal_cdf(value: f64) -> f64 {
    Normal::standard().cdf(value)
}

/// Logarithm of the probability that a standard normal variable is below `value`, also where the probability
/// itself underflows.
#[must_use]
pub fn log_normal_cdf(value: f64) -> f64 {
    if value > -30.0 {
        normal_cdf(value).ln()
    } else {
        // Asymptotic tail, density over distance: Abramowitz and Stegun 26.2.12.
        -0.5 * (value * value + std::f64::consts::TAU.ln()) - (-value).ln()
    }
}

/// Standard normal quantile: the value that is exceeded with probability `1 - probability`.
#[must_use]
pub fn normal_quantile(probability: f64) -> f64 {
    Normal::standard().inverse_cdf(probability)
}

/// A matrix `R` with `R R^T` equal to a covariance, which may be singular.
pub(crate) fn covariance_root(covariance: &DMatrix<f64>) -> DMatrix<f64> {
    let eigen = SymmetricEigen::new(covariance.clone());
    let mut root = eigen.eigenvectors;
    for (mut column, value) in root.column_iter_mut().zip(eigen.eigenvalues.iter()) {
        column *= value.max(0.0).sqrt();
    }
    root
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distributions_match_tabulated_values() {
        // Abramowitz and Stegun, tables 26.8 and 26.5.
        assert!((chi_square_survival(18.307_038, 10.0).unwrap() - 0.05).abs() < 1e-7);
        assert!((normal_two_sided(1.959_963_985) - 0.05).abs() < 1e-9);
        assert!((normal_quantile(0.975) - 1.959_963_985).abs() < 1e-8);
        assert_eq!(chi_square_survival(1.0, 0.0), None);
        assert!((log_normal_cdf(-1.959_963_985) - 0.025_f64.ln()).abs() < 1e-8);
        let [one, other] = [-29.99, -30.01].map(log_normal_cdf);
        assert!(((one - other) / 0.02 - 30.03).abs() < 0.1);
        // Tables 26.8 (0.975 and 0.025 at 10 degrees of freedom) and 26.9 (F at 5 and 10).
        assert!((chi_square_quantile(0.025, 10.0).unwrap() - 3.246_97).abs() < 1e-5);
        assert!((chi_square_two_sided(3.246_97, 10.0).unwrap() - 0.05).abs() < 1e-5);
        assert!((chi_square_two_sided(20.483_2, 10.0).unwrap() - 0.05).abs() < 1e-5);
        assert!((f_survival(3.325_8, [5.0, 10.0]).unwrap() - 0.05).abs() < 1e-5);
        assert_eq!(f_survival(1.0, [5.0, 0.0]), None);
    }
}

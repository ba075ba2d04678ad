//! Probability distributions that tests and intervals need.

use statrs::distribution::{ChiSquared, ContinuousCDF, Normal};

/// Probability that a chi-square variable exceeds `value`; `None` without degrees of freedom.
#[must_use]
pub fn chi_square_survival(value: f64, degrees_of_freedom: f64) -> Option<f64> {
    let distribution = ChiSquared::new(degrees_of_freedom).ok()?;
    Some(distribution.sf(value.max(0.0)))
}

/// Two-sided probability of a standard normal variable at least `size` away from zero.
#[must_use]
pub fn normal_two_sided(size: f64) -> f64 {
    2.0 * Normal::standard().sf(size.abs())
}

/// The standard normal quantile: value that is exceeded with probability `1 - probability`.
#[must_use]
pub fn normal_quantile(probability: f64) -> f64 {
    Normal::standard().inverse_cdf(probability)
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
    }
}

//! Conformity with a tolerance, by the decision rule that was chosen (JCGM 106:2012, clause 8; ILAC-G8:09/2019).

use nalgebra::{Matrix3, Vector3};
use tautline_core::conformance::conformance_probability;
use tautline_session::DecisionRule;

/// Coverage factor of the guard band.
pub const COVERAGE: f64 = 2.0;
/// Probability that a verdict needs by ISO 14253-1:2017.
const ISO_14253: f64 = 0.95;

/// Expanded uncertainty (m) of the length of a displacement with this covariance (m^2), for any direction.
#[must_use]
pub fn expanded_uncertainty_m(covariance: &Matrix3<f64>, coverage_factor: f64) -> f64 {
    coverage_factor * covariance.symmetric_eigenvalues().max().max(0.0).sqrt()
}

/// Conformity with a tolerance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Conformity {
    /// Within the tolerance.
    Within,
    /// Outside the tolerance.
    Outside,
    /// The rule allows neither verdict, or the uncertainty is unknown.
    Undecided,
}

impl Conformity {
    /// Conformity of a displacement (m) with its covariance (m^2) with a tolerance (m) on its length.
    #[must_use]
    pub fn of(
        rule: DecisionRule,
        by: &Vector3<f64>,
        covariance: Option<&Matrix3<f64>>,
        tolerance: f64,
    ) -> Self {
        let Some(covariance) = covariance else {
            return Self::Undecided;
        };
        let distance = by.norm();
        let [is_within, is_outside] = match rule {
            DecisionRule::ExpandedUncertainty => {
                let uncertainty = expanded_uncertainty_m(covariance, COVERAGE);
                [
                    distance + uncertainty <= tolerance,
                    distance - uncertainty > tolerance,
                ]
            }
            DecisionRule::Probability95 => {
                let probability = conformance_probability(by, covariance, tolerance);
                [probability >= ISO_14253, probability <= 1.0 - ISO_14253]
            }
            DecisionRule::SimpleAcceptance => [distance <= tolerance, distance > tolerance],
        };
        match (is_within, is_outside) {
            (true, _) => Self::Within,
            (_, true) => Self::Outside,
            _ => Self::Undecided,
        }
    }

    /// The verdict in words, for a cell of a table.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::Within => "within",
            Self::Outside => "outside",
            Self::Undecided => "not decided",
        }
    }
}

/// A decision rule in a sentence, with the risk that it leaves.
#[must_use]
pub fn rule_in_words(rule: DecisionRule) -> &'static str {
    match rule {
        DecisionRule::ExpandedUncertainty => {
            "Decision rule: guarded acceptance and guarded rejection (JCGM 106, 8.3) with the expanded uncertainty in the least certain direction (k = 2) as guard band on either side of the limit. The risk of a wrong verdict is below 2.5 % for each pulley."
        }
        DecisionRule::Probability95 => {
            "Decision rule: ISO 14253-1:2017, a verdict needs a probability of 95 %. The risk of a wrong verdict is at most 5 % for each pulley."
        }
        DecisionRule::SimpleAcceptance => {
            "Decision rule: simple acceptance (JCGM 106, 8.2), the estimate alone decides. The risk of a wrong verdict is up to 50 % for a pulley whose displacement is close to the limit."
        }
    }
}

/// Name of a decision rule in a list.
#[must_use]
pub fn rule_name(rule: DecisionRule) -> &'static str {
    match rule {
        DecisionRule::ExpandedUncertainty => "Guard band of U (k = 2)",
        DecisionRule::Probability95 => "Probability of 95 % (ISO 14253-1)",
        DecisionRule::SimpleAcceptance => "Simple acceptance",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use DecisionRule::{ExpandedUncertainty, Probability95, SimpleAcceptance};

    #[test]
    fn each_rule_puts_the_uncertainty_where_it_says() {
        // Known to 0.5 mm along x and exactly across: half of the normal distribution lies beyond the estimate.
        let covariance = Matrix3::from_diagonal(&Vector3::new(0.25, 0.0, 0.0));
        for (distance, rule, expected) in [
            (1.0, ExpandedUncertainty, Conformity::Within),
            (1.1, ExpandedUncertainty, Conformity::Undecided),
            (3.1, ExpandedUncertainty, Conformity::Outside),
            // 1.645 standard deviations.
            (1.17, Probability95, Conformity::Within),
            (1.19, Probability95, Conformity::Undecided),
            (2.83, Probability95, Conformity::Outside),
            (1.99, SimpleAcceptance, Conformity::Within),
            (2.01, SimpleAcceptance, Conformity::Outside),
        ] {
            let by = Vector3::new(distance, 0.0, 0.0);
            assert_eq!(
                Conformity::of(rule, &by, Some(&covariance), 2.0),
                expected,
                "{distance}"
            );
            assert_eq!(Conformity::of(rule, &by, None, 2.0), Conformity::Undecided);
        }
    }
}

//! Conformity with a tolerance by ISO 14253-1: the uncertainty counts against whichever verdict is claimed, which is guarded
//! acceptance and guarded rejection (JCGM 106, 8.3) with a guard band of one expanded uncertainty.

use nalgebra::Matrix3;

/// Coverage factor of the expanded uncertainty, for a coverage of about 95 %.
pub const COVERAGE: f64 = 2.0;

/// Expanded uncertainty (m) of the length of a displacement with this covariance (m^2), for any direction.
#[must_use]
pub fn expanded_uncertainty_m(covariance: &Matrix3<f64>) -> f64 {
    COVERAGE * covariance.symmetric_eigenvalues().max().max(0.0).sqrt()
}

/// Conformity with a tolerance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Conformity {
    /// Within the tolerance even with the uncertainty added.
    Within,
    /// Outside the tolerance even with the uncertainty subtracted.
    Outside,
    /// The tolerance is within the uncertainty, or the uncertainty is unknown.
    Undecided,
}

impl Conformity {
    /// Conformity of a distance with its expanded uncertainty; all lengths in one unit.
    #[must_use]
    pub fn of(distance: f64, uncertainty: Option<f64>, tolerance: f64) -> Self {
        match uncertainty {
            Some(uncertainty) if distance + uncertainty <= tolerance => Self::Within,
            Some(uncertainty) if distance - uncertainty > tolerance => Self::Outside,
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_uncertainty_is_on_the_safe_side_of_both_verdicts() {
        for (distance, uncertainty, expected) in [
            (1.0, Some(0.9), Conformity::Within),
            (1.0, Some(1.1), Conformity::Undecided),
            (2.5, Some(0.6), Conformity::Undecided),
            (2.5, Some(0.4), Conformity::Outside),
            (0.0, None, Conformity::Undecided),
        ] {
            assert_eq!(Conformity::of(distance, uncertainty, 2.0), expected);
        }
    }
}

//! Adequacy of a model, judged by the probability of its chi-square.

/// Adequacy of a model, judged by the probability of its chi-square.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FitVerdict {
    /// The model explains the data as a correct one would.
    Adequate,
    /// The fit is worse than that of 99 % of correct models.
    Doubtful,
    /// The model does not explain the data.
    Inadequate,
    /// The data scatter less than the stated noise.
    NoiseOverstated,
    /// The model cannot be tested without redundancy.
    Untested,
}

impl FitVerdict {
    /// Judges by the probability of a chi-square at least as large if model and noise are right.
    #[must_use]
    pub fn of(p_value: Option<f64>) -> Self {
        match p_value {
            None => Self::Untested,
            Some(p) if p < 1e-4 => Self::Inadequate,
            Some(p) if p < 0.01 => Self::Doubtful,
            Some(p) if p > 0.9999 => Self::NoiseOverstated,
            Some(_) => Self::Adequate,
        }
    }

    /// Whether the standard deviations of the fit are valid.
    #[must_use]
    pub fn holds(self) -> bool {
        self != Self::Inadequate
    }

    /// The verdict in words, as the end or the whole of a sentence.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::Adequate => "the model explains the data",
            Self::Doubtful => "the model hardly explains the data",
            Self::Inadequate => "the model does not explain the data",
            Self::NoiseOverstated => "the data scatter less than the stated noise",
            Self::Untested => "the model cannot be tested without redundant readings",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_probability_of_chi_square_decides() {
        for (p_value, expected) in [
            (None, FitVerdict::Untested),
            (Some(1e-9), FitVerdict::Inadequate),
            (Some(0.001), FitVerdict::Doubtful),
            (Some(0.3), FitVerdict::Adequate),
            (Some(0.999_999), FitVerdict::NoiseOverstated),
        ] {
            assert_eq!(FitVerdict::of(p_value), expected);
        }
    }
}

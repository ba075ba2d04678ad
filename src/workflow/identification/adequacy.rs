//! Whether a model explains the data, by the probability of its chi-square.

/// How well a model explains the data.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Explains {
    /// As a right model does.
    Yes,
    /// Worse than 99 of 100 right models would.
    Hardly,
    /// Not at all.
    No,
    /// The data scatter less than the stated noise.
    TooWell,
    /// Nothing is redundant: it cannot be checked.
    Unchecked,
}

impl Explains {
    /// By the probability of a chi-square at least as large if model and noise are right.
    #[must_use]
    pub fn of(p_value: Option<f64>) -> Self {
        match p_value {
            None => Self::Unchecked,
            Some(p) if p < 1e-4 => Self::No,
            Some(p) if p < 0.01 => Self::Hardly,
            Some(p) if p > 0.9999 => Self::TooWell,
            Some(_) => Self::Yes,
        }
    }

    /// In words, as the end or the whole of a sentence.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::Yes => "the model explains the data",
            Self::Hardly => "the model hardly explains the data",
            Self::No => "the model does not explain the data",
            Self::TooWell => "the data scatter less than the stated noise",
            Self::Unchecked => "the data cannot be checked, nothing is redundant",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_a_right_model_does_is_an_explanation() {
        for (p_value, expected) in [
            (None, Explains::Unchecked),
            (Some(1e-9), Explains::No),
            (Some(0.001), Explains::Hardly),
            (Some(0.3), Explains::Yes),
            (Some(0.999_999), Explains::TooWell),
        ] {
            assert_eq!(Explains::of(p_value), expected);
        }
    }
}

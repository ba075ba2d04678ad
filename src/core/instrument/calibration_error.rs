//! Errors of the calibrations of phase 1.

/// Reasons why pairs of readings do not allow a calibration.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum CalibrationError {
    /// Fewer pairs than a fit with standard deviations needs.
    #[error("{given} pairs are too few: {needed} are needed to fit {what} and judge the residuals")]
    TooFewPairs {
        /// The model to be fitted.
        what: &'static str,
        /// Smallest sufficient number of pairs.
        needed: usize,
        /// Number of pairs given.
        given: usize,
    },
    /// A value is NaN or infinite.
    #[error("pair {pair} holds a value that is not a finite number")]
    NotFinite {
        /// Number of the pair, from 1.
        pair: usize,
    },
    /// The pairs do not determine the parameters.
    #[error("{0}")]
    Degenerate(String),
}

/// Rejects too few pairs and values that are not finite.
pub(super) fn check_pairs<const N: usize>(
    pairs: impl ExactSizeIterator<Item = [f64; N]>,
    what: &'static str,
    needed: usize,
) -> Result<(), CalibrationError> {
    let given = pairs.len();
    if given < needed {
        return Err(CalibrationError::TooFewPairs {
            what,
            needed,
            given,
        });
    }
    for (index, values) in pairs.enumerate() {
        if !values.iter().all(|v| v.is_finite()) {
            return Err(CalibrationError::NotFinite { pair: index + 1 });
        }
    }
    Ok(())
}

//! Consistency of a robot description.

use super::Robot;

/// What is wrong with one field of a robot description.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{pointer}: {message}")]
pub struct FieldError {
    /// JSON pointer to the field, such as `/cables/3/pulley/radius_m`.
    pub pointer: String,
    /// What was found and what was expected, one sentence.
    pub message: String,
}

impl Robot {
    /// Checks everything that can be wrong in a description by itself.
    ///
    /// # Errors
    /// The first field that no robot can have.
    pub fn check(&self) -> Result<(), FieldError> {
        Ok(())
    }
}

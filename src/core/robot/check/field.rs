//! Checks of single fields.

use std::fmt::Display;

use super::{Checked, FieldError};
use crate::geometry::Vec3;

/// Largest deviation of the norm of a direction or quaternion from one.
const NORM_TOLERANCE: f64 = 1e-6;

/// An object of the description, known by its JSON pointer.
pub(super) struct Object {
    pointer: String,
}

impl Object {
    /// The whole document.
    pub fn root() -> Self {
        Self {
            pointer: String::new(),
        }
    }

    /// The object (or list) under `key`.
    pub fn child(&self, key: impl Display) -> Self {
        Self {
            pointer: self.pointer_to(key),
        }
    }

    fn pointer_to(&self, key: impl Display) -> String {
        let key = key.to_string().replace('~', "~0").replace('/', "~1");
        format!("{}/{key}", self.pointer)
    }

    /// Rejects the field `key`.
    pub fn fail(&self, key: impl Display, message: impl Into<String>) -> Checked {
        Err(FieldError {
            pointer: self.pointer_to(key),
            message: message.into(),
        })
    }

    pub fn finite(&self, key: impl Display, value: f64) -> Checked {
        self.ensure(value.is_finite(), key, value, "a finite number")
    }

    pub fn positive(&self, key: impl Display, value: f64) -> Checked {
        let good = value.is_finite() && value > 0.0;
        self.ensure(good, key, value, "a number greater than 0")
    }

    pub fn not_negative(&self, key: impl Display, value: f64) -> Checked {
        let good = value.is_finite() && value >= 0.0;
        self.ensure(good, key, value, "0 or a greater number")
    }

    pub fn not_zero(&self, key: impl Display, value: f64) -> Checked {
        let good = value.is_finite() && value != 0.0;
        self.ensure(good, key, value, "a number other than 0")
    }

    /// Rejects a length that no robot has in metres.
    pub fn below(&self, key: impl Display, value: f64, limit_m: f64) -> Checked {
        if value > limit_m {
            let message =
                format!("found {value} m, expected at most {limit_m} m: it looks like millimetres");
            return self.fail(key, message);
        }
        Ok(())
    }

    pub fn vector(&self, key: impl Display, values: &[f64]) -> Checked {
        match values.iter().position(|value| !value.is_finite()) {
            Some(k) => self.child(key).finite(k, values[k]),
            None => Ok(()),
        }
    }

    pub fn unit_vector(&self, key: &str, values: &[f64; 3]) -> Checked {
        self.unit_norm(key, values, "a unit vector")
    }

    pub fn quaternion(&self, key: &str, values: &[f64; 4]) -> Checked {
        self.unit_norm(key, values, "a unit quaternion, w first")
    }

    fn unit_norm(&self, key: &str, values: &[f64], expected: &str) -> Checked {
        self.vector(key, values)?;
        let norm = values.iter().map(|v| v * v).sum::<f64>().sqrt();
        if (norm - 1.0).abs() > NORM_TOLERANCE {
            let message = format!("found the norm {norm}, expected {expected}");
            return self.fail(key, message);
        }
        Ok(())
    }

    /// Rejects a direction within 2.5 degrees of another one.
    pub fn not_parallel(
        &self,
        key: &str,
        direction: &[f64; 3],
        other_name: &str,
        other: &[f64; 3],
    ) -> Checked {
        let cosine = Vec3::from(*direction).dot(&Vec3::from(*other));
        if cosine.abs() > 0.999 {
            let message =
                format!("found a direction parallel to {other_name}, expected a different one");
            return self.fail(key, message);
        }
        Ok(())
    }

    pub fn not_blank(&self, key: &str, text: &str) -> Checked {
        if text.trim().is_empty() {
            return self.fail(key, "found an empty text, expected a name");
        }
        if text.trim() != text {
            return self.fail(key, "found spaces around the name, expected none");
        }
        if text.chars().any(char::is_control) {
            return self.fail(
                key,
                "found a control character, expected a name on one line",
            );
        }
        Ok(())
    }

    pub fn count(&self, key: &str, found: usize, expected: usize) -> Checked {
        if found != expected {
            return self.fail(key, format!("found {found}, expected {expected}"));
        }
        Ok(())
    }

    fn ensure(&self, good: bool, key: impl Display, value: f64, expected: &str) -> Checked {
        if good {
            return Ok(());
        }
        self.fail(key, format!("found {value}, expected {expected}"))
    }
}

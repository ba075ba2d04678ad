//! Goals of a measurement that ends as soon as they are reached.

use std::fmt;
use std::str::FromStr;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Condition on which a measurement ends; in files the text of the command line, such as `accuracy=0.3mm`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(try_from = "String", into = "String")]
#[schemars(with = "String")]
pub enum Goal {
    /// All coordinates of all entry points have standard deviations of at most this (m).
    Accuracy(f64),
    /// The causes, or their absence, are known with this probability.
    Cause(f64),
    /// The absence of faults of typical size is known with this probability.
    FaultFree(f64),
}

/// Range of permitted probabilities: below, a statement would be worthless; above, errors outside the catalogue, which may look
/// like a cause, leave too much doubt.
pub const PROBABILITIES: [f64; 2] = [0.5, 0.98];

const EXPECTED: &str = "expected accuracy=0.3mm, cause=95% or fault-free=95%";

/// A text that does not state a goal; one sentence.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct GoalError(String);

impl Goal {
    /// Name in commands and files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Accuracy(_) => "accuracy",
            Self::Cause(_) => "cause",
            Self::FaultFree(_) => "fault-free",
        }
    }
}

impl FromStr for Goal {
    type Err = GoalError;

    fn from_str(text: &str) -> Result<Self, GoalError> {
        let unknown = || GoalError(format!("found \"{text}\", {EXPECTED}"));
        let (name, value) = text.split_once('=').ok_or_else(unknown)?;
        match name.trim() {
            "accuracy" => Ok(Self::Accuracy(length_m(value.trim())?)),
            "cause" => Ok(Self::Cause(probability(value.trim())?)),
            "fault-free" => Ok(Self::FaultFree(probability(value.trim())?)),
            _ => Err(unknown()),
        }
    }
}

impl TryFrom<String> for Goal {
    type Error = GoalError;

    fn try_from(text: String) -> Result<Self, GoalError> {
        text.parse()
    }
}

impl From<Goal> for String {
    fn from(goal: Goal) -> Self {
        goal.to_string()
    }
}

impl fmt::Display for Goal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Accuracy(limit_m) => write!(f, "accuracy={}mm", rounded(limit_m * 1e3)),
            Self::Cause(probability) | Self::FaultFree(probability) => {
                write!(f, "{}={}%", self.name(), rounded(probability * 100.0))
            }
        }
    }
}

/// The number without the rounding error of a change of unit.
fn rounded(value: f64) -> f64 {
    (value * 1e9).round() / 1e9
}

fn length_m(text: &str) -> Result<f64, GoalError> {
    let units = [("mm", 1e-3), ("um", 1e-6), ("\u{b5}m", 1e-6), ("m", 1.0)];
    let of = |(unit, size): &(&str, f64)| Some((text.strip_suffix(unit)?, *size));
    let split = units.iter().find_map(of);
    let length = split.and_then(|(number, size)| Some(number.trim().parse::<f64>().ok()? * size));
    let is_length = |length: &f64| length.is_finite() && *length > 0.0;
    length.filter(is_length).ok_or_else(|| {
        GoalError(format!(
            "accuracy: found \"{text}\", expected a positive length with its unit, such as 0.3mm"
        ))
    })
}

fn probability(text: &str) -> Result<f64, GoalError> {
    let number = match text.strip_suffix('%') {
        Some(percent) => percent.trim().parse::<f64>().map(|value| value / 100.0),
        None => text.parse(),
    };
    let [least, most] = PROBABILITIES;
    let is_possible = |value: &f64| (least..=most).contains(value);
    number.ok().filter(is_possible).ok_or_else(|| {
        GoalError(format!(
            "found the probability \"{text}\", expected {} to {}%, such as 95%",
            least * 100.0,
            most * 100.0
        ))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn goals_are_read_with_their_units_and_written_as_they_are_read() {
        for (text, goal) in [
            ("accuracy=0.3mm", Goal::Accuracy(0.3e-3)),
            ("accuracy=250um", Goal::Accuracy(250e-6)),
            ("accuracy = 0.002 m", Goal::Accuracy(2e-3)),
            ("cause=95%", Goal::Cause(0.95)),
            ("cause=0.9", Goal::Cause(0.9)),
            ("fault-free=97.5%", Goal::FaultFree(0.975)),
        ] {
            let read: Goal = text.parse().unwrap();
            let same = match (read, goal) {
                (Goal::Accuracy(a), Goal::Accuracy(b))
                | (Goal::Cause(a), Goal::Cause(b))
                | (Goal::FaultFree(a), Goal::FaultFree(b)) => (a - b).abs() < 1e-12,
                _ => false,
            };
            assert!(same, "{text}: {read:?}");
            let again: Goal = read.to_string().parse().unwrap();
            assert_eq!(again.to_string(), read.to_string());
        }
        assert_eq!(Goal::Accuracy(0.3e-3).to_string(), "accuracy=0.3mm");
        assert_eq!(Goal::Cause(0.95).to_string(), "cause=95%");
    }

    #[test]
    fn what_is_no_goal_is_refused_in_a_sentence() {
        for (text, parts) in [
            (
                "precision=1mm",
                ["\"precision=1mm\"", "accuracy=0.3mm, cause=95%"],
            ),
            ("cause", ["\"cause\"", "fault-free=95%"]),
            ("accuracy=0.3", ["\"0.3\"", "with its unit"]),
            ("accuracy=-1mm", ["\"-1mm\"", "positive length"]),
            ("accuracy=nanmm", ["\"nanmm\"", "positive length"]),
            ("cause=95", ["\"95\"", "50 to 98%"]),
            ("cause=99.9%", ["\"99.9%\"", "50 to 98%"]),
            ("fault-free=mostly", ["\"mostly\"", "such as 95%"]),
        ] {
            let told = text.parse::<Goal>().unwrap_err().to_string();
            assert!(parts.iter().all(|part| told.contains(part)), "{told}");
            assert_eq!(told.lines().count(), 1);
        }
    }
}

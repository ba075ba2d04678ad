//! Parameters of the controller and the values written to it.

use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize};

use super::Timestamp;

/// A named number.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct NamedValue {
    /// Name.
    pub name: String,
    /// Value; null in a file if the controller holds NaN or infinity.
    #[serde(deserialize_with = "number_or_null")]
    #[schemars(with = "Option<f64>")]
    pub value: f64,
}

/// One attempt to write identified values to the controller.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Adjustment {
    /// Time of the attempt.
    pub time: Timestamp,
    /// Operator.
    pub operator: String,
    /// Name of the controller.
    pub controller: String,
    /// The parameters concerned.
    pub changes: Vec<ValueChange>,
    /// Its outcome.
    pub outcome: Outcome,
    /// The values of these parameters as they were read after it; empty in files of earlier versions, and if they could not be
    /// read.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub read_back: Vec<NamedValue>,
    /// Whether it was to bring back the values from before an earlier one.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub restores: bool,
}

impl Adjustment {
    /// Whether the controller may hold both old and new values: nothing may move before it is settled.
    #[must_use]
    pub fn is_open(&self) -> bool {
        matches!(self.outcome, Outcome::Begun | Outcome::Unsettled(_))
    }
}

/// One parameter of a controller before and after a change.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ValueChange {
    /// Name in the controller.
    pub name: String,
    /// Unit.
    pub unit: String,
    /// The old value; null in a file if the controller held NaN or infinity.
    #[serde(deserialize_with = "number_or_null")]
    #[schemars(with = "Option<f64>")]
    pub before: f64,
    /// The new value; null in a file if the controller holds NaN or infinity.
    #[serde(deserialize_with = "number_or_null")]
    #[schemars(with = "Option<f64>")]
    pub after: f64,
}

/// Outcome of an adjustment.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// Values are about to be written. If this is the last outcome, the program ended during the attempt, and the
    /// controller may hold both old and new values.
    Begun,
    /// All values were written and read back.
    Written,
    /// The old values were written back.
    RolledBack,
    /// It failed, and the controller holds its old values; one sentence states the reason.
    Failed(String),
    /// The controller holds both old and new values, or no longer answered; one sentence states the reason.
    Unsettled(String),
}

/// A number, or NaN for null, which replaces it in JSON.
fn number_or_null<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    Ok(Option::deserialize(from)?.unwrap_or(f64::NAN))
}

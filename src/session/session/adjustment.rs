//! Parameters of the controller and what was written to it.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Timestamp;

/// A number with a name.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct NamedValue {
    /// Its name.
    pub name: String,
    /// Its value.
    pub value: f64,
}

/// One attempt to write identified values to the controller.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Adjustment {
    /// When.
    pub time: Timestamp,
    /// Who did it.
    pub operator: String,
    /// Which controller.
    pub controller: String,
    /// The parameters concerned.
    pub changes: Vec<ValueChange>,
    /// Its outcome.
    pub outcome: Outcome,
}

/// One parameter of a controller before and after an adjustment.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ValueChange {
    /// Its name in the controller.
    pub name: String,
    /// Its unit.
    pub unit: String,
    /// The old value.
    pub before: f64,
    /// The new value.
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
    /// It failed; one sentence says why.
    Failed(String),
}

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
    /// What came of it.
    pub outcome: Outcome,
}

/// One parameter of a controller before and after an adjustment.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ValueChange {
    /// Its name in the controller.
    pub name: String,
    /// Its unit.
    pub unit: String,
    /// The value that was there.
    pub before: f64,
    /// The value that was to be written.
    pub after: f64,
}

/// What came of an adjustment.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// Values are about to be written. Whoever finds this as the last outcome finds an attempt that the end of the
    /// program interrupted: the controller may hold old and new values.
    Begun,
    /// All values were written and read back.
    Written,
    /// The old values were written back.
    RolledBack,
    /// It failed, and why, one sentence.
    Failed(String),
}

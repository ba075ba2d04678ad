//! Runs that show how exactly the robot moves.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Timestamp;
use crate::phases::CheckRow;

/// Whether a run came before or after the adjustment.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Stage {
    /// With the values that the controller had.
    Before,
    /// With the identified values.
    After,
}

/// One run with an external instrument.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Verification {
    /// When.
    pub time: Timestamp,
    /// What the operator calls it.
    pub title: String,
    /// Before or after the adjustment.
    pub stage: Stage,
    /// Commanded and attained poses.
    pub rows: Vec<CheckRow>,
    /// Who has accepted the robot on this result.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub accepted: Option<Acceptance>,
}

/// Somebody has accepted the robot as it is.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Acceptance {
    /// When.
    pub time: Timestamp,
    /// Who.
    pub operator: String,
}

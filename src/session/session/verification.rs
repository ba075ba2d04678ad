//! Verification runs, which measure the accuracy of the robot.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Timestamp;
use crate::phases::CheckRow;

/// Stage of a run: before or after the adjustment.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Stage {
    /// With the previous values of the controller.
    Before,
    /// With the identified values.
    After,
}

/// One run with an external instrument.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Verification {
    /// Time of the run.
    pub time: Timestamp,
    /// Title for the operator.
    pub title: String,
    /// Before or after the adjustment.
    pub stage: Stage,
    /// Commanded and attained poses.
    pub rows: Vec<CheckRow>,
    /// Acceptance of the robot on this result.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub accepted: Option<Acceptance>,
}

/// A run that ended before all targets were measured. It is no [`Verification`]: no accuracy follows from some of the targets.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct StoppedVerification {
    /// Time at which it ended.
    pub time: Timestamp,
    /// Before or after the adjustment.
    pub stage: Stage,
    /// Commanded and attained poses until then.
    pub rows: Vec<CheckRow>,
    /// Number of measurements that were planned.
    pub planned: usize,
    /// Reason for its end, in one sentence.
    pub reason: String,
}

/// Acceptance of the robot by an operator.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Acceptance {
    /// Time of acceptance.
    pub time: Timestamp,
    /// Operator.
    pub operator: String,
    /// Fingerprint of the values that the controller held ([`super::Session::controller_fingerprint`]); absent in files of
    /// earlier versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub values: Option<String>,
}

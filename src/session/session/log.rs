//! Log of a session: steps of the operator, and results.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::{ResultDocument, Timestamp};

/// Phase of the calibration that a step belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Phase {
    /// Phase 1: winches, force sensors, home reference platform.
    Instruments,
    /// Phase 2: description of the robot, elongation of its cables.
    Cables,
    /// Phase 3: measured poses.
    Poses,
    /// Phase 4: identification.
    Identification,
    /// Between 4 and 5: diagnosis of the model.
    Diagnosis,
    /// Phase 5: which controller it is, and values written to it.
    Controller,
    /// Phase 5: accuracy measured by an external instrument.
    Accuracy,
    /// The session itself: opened, renamed, exported.
    Session,
}

/// One step of the operator.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct LogEntry {
    /// Time of the step.
    pub time: Timestamp,
    /// Phase of the calibration.
    pub phase: Phase,
    /// What was done, in one sentence.
    pub text: String,
}

/// A reading that was implausible when its pose was measured.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct MeasuringWarning {
    /// Label of the pose.
    pub pose: i64,
    /// The warning in one sentence.
    pub text: String,
}

/// A result, stored as the document that the commands write with `--json`.
///
/// It is stored as a document rather than as a type, so that a session keeps results of kinds that
/// this version of the program does not know, and old results stay exactly as the
/// operator saw them. Its `format` and `version` define how to read it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ResultRecord {
    /// Time of the computation.
    pub time: Timestamp,
    /// Title for the operator.
    pub title: String,
    /// The document, such as a `tautline-identification` or a `tautline-robot` (a model).
    #[schemars(with = "Value")]
    pub document: ResultDocument,
    /// Fingerprint of its inputs ([`super::Session::basis`]).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub basis: Option<String>,
}

impl ResultRecord {
    /// The `format` of the document, if it states one.
    #[must_use]
    pub fn format(&self) -> Option<&str> {
        self.document.format()
    }
}

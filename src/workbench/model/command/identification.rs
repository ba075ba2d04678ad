//! Identification and diagnosis.

use tautline_core::effect::EffectSetting;
use tautline_session::ResultRecord;

use crate::model::open_session::PlottedDiagnosis;
use tautline_workflow::formulas::PatternDocument;
use tautline_workflow::identification::Identification;
use tautline_workflow::isolability::IsolabilityTable;
use tautline_workflow::readiness::CheckItem;

pub const IDENTIFYING: &str = "Identifying";

/// Title of the task that diagnoses the model.
pub const DIAGNOSING: &str = "Looking for what the model lacks";

/// Title of the task that looks for patterns in the unexplained residuals.
pub const FORMULAS: &str = "Trying patterns";

/// Title of the task that checks the readings before identification.
pub const READINESS: &str = "Checking the readings";

#[derive(Debug, Clone)]
pub enum IdentificationCommand {
    /// Checks whether the readings are fit for identification.
    Check,
    Identify,
    /// Diagnoses the model.
    Diagnose,
    /// Looks for patterns in errors that no cause explains.
    FindFormulas,
    /// Stops the running computation.
    Stop,
}

/// Outcome of an identification; `inputs` is the number of the inputs it was computed from.
#[derive(Debug)]
pub enum IdentificationOutcome {
    /// Check of the readings before the identification.
    Checked {
        inputs: u64,
        readiness: Box<Readiness>,
    },
    Identified {
        inputs: u64,
        /// Record for the session; `None` if the session has it already.
        record: Option<Box<ResultRecord>>,
        /// Identification, or an error message; `None` if it was cancelled.
        result: Result<Option<Box<Identification>>, String>,
    },
    Diagnosed {
        inputs: u64,
        /// Diagnosis, or an error message; `None` if it was cancelled.
        result: Result<Option<Box<DiagnosisResult>>, String>,
    },
    /// Patterns in the unexplained residuals.
    Formulas {
        inputs: u64,
        /// Patterns, or an error message; `None` if it was cancelled.
        result: Result<Option<Vec<PatternDocument>>, String>,
    },
}

/// Result of the check of the readings.
#[derive(Debug, Clone, PartialEq)]
pub struct Readiness {
    /// Checks that need an identification.
    pub checks: Vec<CheckItem>,
    /// Faults that these poses can detect and isolate.
    pub faults: Option<IsolabilityTable>,
}

/// Diagnosis with its plots.
#[derive(Debug)]
pub struct DiagnosisResult {
    pub(crate) result: PlottedDiagnosis,
    /// Effects of the diagnosed model.
    pub(crate) effects: Vec<EffectSetting>,
    /// Record for the session; `None` if the session has it already.
    pub(crate) record: Option<ResultRecord>,
}

//! Identification and diagnosis.

use tautline_core::effect::EffectSetting;
use tautline_session::ResultRecord;

use crate::model::open_session::PlottedDiagnosis;
use tautline_workflow::formulas::PatternDocument;
use tautline_workflow::identification::Identification;
use tautline_workflow::isolability::IsolabilityTable;
use tautline_workflow::readiness::CheckItem;

pub const IDENTIFYING: &str = "Identifying";

/// Title of the task that looks for what the model lacks.
pub const DIAGNOSING: &str = "Looking for what the model lacks";

/// Title of the task that looks for patterns of what is unexplained.
pub const FORMULAS: &str = "Trying patterns";

/// Title of the task that checks the readings before identification.
pub const READINESS: &str = "Checking the readings";

#[derive(Debug, Clone)]
pub enum IdentificationCommand {
    /// Checks whether the readings are fit for identification.
    Check,
    Identify,
    /// Asks what the model gets wrong.
    Diagnose,
    /// Asks what errors look like that no cause explains.
    FindFormulas,
    /// Ends what is being computed.
    Stop,
}

/// Outcome of an identification; `inputs` is the number of the inputs it was computed from.
#[derive(Debug)]
pub enum IdentificationOutcome {
    /// Of the check before it.
    Checked {
        inputs: u64,
        readiness: Box<Readiness>,
    },
    Identified {
        inputs: u64,
        /// The record for the session; none where the session has it already.
        record: Option<Box<ResultRecord>>,
        /// The fit, or one sentence; `None` if it was stopped.
        result: Result<Option<Box<Identification>>, String>,
    },
    Diagnosed {
        inputs: u64,
        /// The diagnosis, or one sentence; `None` if it was stopped.
        result: Result<Option<Box<DiagnosisResult>>, String>,
    },
    /// Patterns of what is unexplained.
    Formulas {
        inputs: u64,
        /// The patterns, or one sentence; `None` if it was stopped.
        result: Result<Option<Vec<PatternDocument>>, String>,
    },
}

/// The check of the readings, as the panel shows it.
#[derive(Debug, Clone, PartialEq)]
pub struct Readiness {
    /// The parts that need a fit.
    pub checks: Vec<CheckItem>,
    /// Which faults the poses show.
    pub faults: Option<IsolabilityTable>,
}

/// A diagnosis with what the panel shows of it.
#[derive(Debug)]
pub struct DiagnosisResult {
    pub(crate) result: PlottedDiagnosis,
    /// Effects of the model that was diagnosed.
    pub(crate) effects: Vec<EffectSetting>,
    /// The record for the session; none where the session has it already.
    pub(crate) record: Option<ResultRecord>,
}

//! Machine-readable form of formulas: a public format.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tautline_session::VersionedFile;

use super::FoundFormulas;
use crate::documents::diagnosis::{GainDocument, ParameterDocument};

/// What unexplained errors look like.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FormulasDocument {
    /// The errors that no cause explains, as sentences; empty if there are none.
    pub unexplained: Vec<String>,
    /// Patterns that describe them, the likeliest first; none of them is a cause.
    pub patterns: Vec<PatternDocument>,
    /// Time of the last diagnosis (s).
    pub seconds: f64,
}

/// A pattern that an unexplained error looks like.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PatternDocument {
    /// The formula without its size, such as `wrap * position_z`.
    pub expression: String,
    /// Identifier of its hypothesis.
    pub effect: String,
    /// Cables; empty for an instrument.
    pub targets: Vec<String>,
    /// Posterior probability, given that one of the patterns of the error is true.
    pub probability: f64,
    /// Its sizes; empty for all but the likeliest of an error.
    pub parameters: Vec<ParameterDocument>,
    /// Improvement at held-out poses; null for all but the likeliest of an error.
    pub gain: Option<GainDocument>,
    /// The text of a hypothesis file with it.
    pub hypothesis: String,
}

impl VersionedFile for FormulasDocument {
    const FORMAT: &'static str = "tautline-formulas";
    const VERSION: u32 = 1;
    const MAX_BYTES: u64 = 16 << 20;
}

impl FormulasDocument {
    /// The document; without formulas if nothing is unexplained.
    #[must_use]
    pub fn of(unexplained: Vec<String>, found: Option<&FoundFormulas>) -> Self {
        Self {
            unexplained,
            patterns: found.map(FoundFormulas::patterns).unwrap_or_default(),
            seconds: found.map_or(0.0, |found| found.after.seconds),
        }
    }
}

//! Machine-readable form of formulas: a public format.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tautline_session::VersionedFile;

use super::FoundFormulas;
use crate::diagnosis::{GainDocument, ParameterDocument};
use crate::wording::list;
use crate::wording::units::with_sd;

/// Formulas that describe unexplained errors.
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
    /// The text of a hypothesis file with the formula.
    pub hypothesis: String,
}

impl PatternDocument {
    /// The formula with its cables.
    #[must_use]
    pub fn title(&self) -> String {
        match self.targets.as_slice() {
            [] => self.expression.clone(),
            targets => format!("{} ({})", self.expression, list(targets)),
        }
    }

    /// Its sizes with standard deviations; empty where they are not known.
    #[must_use]
    pub fn sizes(&self) -> String {
        let sizes = self.parameters.iter().map(|parameter| {
            let sd = parameter.sd.unwrap_or(f64::NAN);
            with_sd(parameter.value, sd, &parameter.unit)
        });
        sizes.collect::<Vec<_>>().join(", ")
    }

    /// Residuals at held-out poses with it instead of without it, over the noise: `1.08 instead of 4.87`.
    #[must_use]
    pub fn held_out(&self) -> Option<String> {
        let gain = self.gain.as_ref()?;
        let (after, before) = gain.holdout_after.zip(gain.holdout_before)?;
        Some(format!("{after:.2} instead of {before:.2}"))
    }
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

//! Machine-readable form of a verification: a public format.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tautline_session::{Session, Stage, VersionedFile};

use super::{Accuracy, figures};

/// Accuracy of a robot before and after the adjustment of its controller.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct VerificationDocument {
    /// Stage of this run.
    pub stage: Stage,
    /// The last run before the adjustment; null if there was none.
    pub before: Option<Accuracy>,
    /// The last run after the adjustment; null if there was none.
    pub after: Option<Accuracy>,
}

impl VersionedFile for VerificationDocument {
    const FORMAT: &'static str = "tautline-verification";
    const VERSION: u32 = 1;
    const MAX_BYTES: u64 = 1 << 30;
}

impl VerificationDocument {
    /// The document of the last runs of a session.
    ///
    /// # Errors
    /// One sentence if the rows of a pose or path are inconsistent.
    pub fn of(session: &Session, stage: Stage) -> Result<Self, String> {
        let last = |stage: Stage| {
            let mut runs = session.verifications().iter().rev();
            let run = runs.find(|run| run.stage == stage);
            run.map(|run| figures(&run.rows)).transpose()
        };
        Ok(Self {
            stage,
            before: last(Stage::Before)?,
            after: last(Stage::After)?,
        })
    }
}

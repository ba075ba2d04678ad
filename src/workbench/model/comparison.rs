//! Two sessions that are compared.

use std::path::PathBuf;
use std::sync::Arc;

use tautline_core::comparison::Comparison;
use tautline_session::Timestamp;

use tautline_workflow::comparison::{LEVEL, compare_identifications};
use tautline_workflow::identification::Identification;
use tautline_workflow::replay::Replay;

/// One of the two places of a comparison.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    A,
    /// The second: what differs is this less the first.
    B,
}

impl Side {
    pub const ALL: [Self; 2] = [Self::A, Self::B];

    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::A => "A",
            Self::B => "B",
        }
    }
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Source {
    Open,
    /// A session file, or a dataset folder.
    File(PathBuf),
}

/// One of the two sessions.
#[derive(Debug)]
pub struct Run {
    pub name: String,
    /// Time of its last measurement.
    pub measured: Option<Timestamp>,
    pub source: Source,
    pub is_simulated: bool,
    pub fit: Arc<Identification>,
    /// Number of the inputs of the open session, if it is that one.
    pub inputs: Option<u64>,
}

/// Two sessions with what differs.
#[derive(Debug)]
pub struct Compared {
    pub runs: [Arc<Run>; 2],
    /// B less A.
    pub comparison: Comparison,
}

impl Compared {
    /// Compares A and B.
    ///
    /// # Errors
    /// One sentence, if the robots have other cables or one of the sessions leaves its geometry open.
    pub fn new(runs: [Arc<Run>; 2]) -> Result<Self, String> {
        let fits = runs.each_ref().map(|run| run.fit.as_ref());
        Ok(Self {
            comparison: compare_identifications(fits, LEVEL)?,
            runs,
        })
    }
}

/// A simulator beside the machine.
#[derive(Debug)]
pub struct SimulatorComparison {
    /// Number of the session.
    pub session: u64,
    /// Name of the file with the readings of the simulator.
    pub file: String,
    /// The comparison, or one sentence.
    pub result: Result<Box<Replay>, String>,
}

/// The sessions to compare, and the comparison.
#[derive(Debug, Default)]
pub struct ComparisonState {
    sources: [Option<Source>; 2],
    result: Option<Result<Arc<Compared>, String>>,
    /// The last comparison that succeeded; its identifications are used again.
    known: Option<Arc<Compared>>,
    number: u64,
    /// A simulator beside the machine.
    pub simulator: Option<SimulatorComparison>,
}

impl ComparisonState {
    /// Where one of the two sessions comes from, if it was chosen.
    #[must_use]
    pub fn source(&self, side: Side) -> Option<&Source> {
        self.sources[side as usize].as_ref()
    }

    /// The last comparison, or why there is none.
    #[must_use]
    pub fn result(&self) -> Option<&Result<Arc<Compared>, String>> {
        self.result.as_ref()
    }

    /// The last comparison that succeeded.
    #[must_use]
    pub fn known(&self) -> Option<&Arc<Compared>> {
        self.known.as_ref()
    }

    pub fn choose(&mut self, side: Side, source: Source) {
        self.sources[side as usize] = Some(source);
    }

    pub fn clear(&mut self, side: Side) {
        self.sources[side as usize] = None;
        self.begin();
    }

    pub fn swap(&mut self) {
        self.sources.swap(0, 1);
    }

    /// Begins a comparison: the number of its result.
    pub fn begin(&mut self) -> u64 {
        self.result = None;
        self.number += 1;
        self.number
    }

    /// Whether the result of this number is waited for.
    #[must_use]
    pub fn expects(&self, number: u64) -> bool {
        self.number == number
    }

    pub fn take(&mut self, result: Result<Arc<Compared>, String>) {
        if let Ok(compared) = &result {
            self.known = Some(Arc::clone(compared));
        }
        self.result = Some(result);
    }
}

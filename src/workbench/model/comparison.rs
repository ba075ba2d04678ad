//! Comparison of two sessions, or of a simulator with the machine.

use std::path::PathBuf;
use std::sync::Arc;

use tautline_core::comparison::Comparison;
use tautline_session::Timestamp;

use tautline_workflow::comparison::{LEVEL, compare_identifications};
use tautline_workflow::identification::Identification;
use tautline_workflow::replay::Replay;

/// One of the two sessions of a comparison.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    A,
    /// The second session; differences are B minus A.
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
pub enum SessionSource {
    Open,
    /// Session file or dataset folder.
    File(PathBuf),
}

/// One of the two sessions, with its identification.
#[derive(Debug)]
pub struct ComparedSession {
    pub name: String,
    /// Time of its last measurement.
    pub measured: Option<Timestamp>,
    pub source: SessionSource,
    pub is_simulated: bool,
    pub fit: Arc<Identification>,
    /// Number of the inputs, if this is the open session.
    pub inputs: Option<u64>,
}

/// Two sessions and their comparison.
#[derive(Debug)]
pub struct Compared {
    pub runs: [Arc<ComparedSession>; 2],
    /// B minus A.
    pub comparison: Comparison,
}

impl Compared {
    /// Compares A and B.
    ///
    /// # Errors
    /// An error message, if the numbers of cables differ or the geometry of a session is not determined.
    pub fn new(runs: [Arc<ComparedSession>; 2]) -> Result<Self, String> {
        let fits = runs.each_ref().map(|run| run.fit.as_ref());
        Ok(Self {
            comparison: compare_identifications(fits, LEVEL)?,
            runs,
        })
    }
}

/// Comparison of a simulator with the machine.
#[derive(Debug)]
pub struct SimulatorComparison {
    /// Id of the session.
    pub session: u64,
    /// Name of the file with the simulator's readings.
    pub file: String,
    /// Comparison, or an error message.
    pub result: Result<Box<Replay>, String>,
}

/// State of the comparison.
#[derive(Debug, Default)]
pub struct ComparisonState {
    sources: [Option<SessionSource>; 2],
    result: Option<Result<Arc<Compared>, String>>,
    /// Last successful comparison; its identifications are reused.
    known: Option<Arc<Compared>>,
    number: u64,
    /// Last comparison of a simulator with the machine.
    pub simulator: Option<SimulatorComparison>,
}

impl ComparisonState {
    /// Source of one of the two sessions, if chosen.
    #[must_use]
    pub fn source(&self, side: Side) -> Option<&SessionSource> {
        self.sources[side as usize].as_ref()
    }

    /// Last comparison, or an error message.
    #[must_use]
    pub fn result(&self) -> Option<&Result<Arc<Compared>, String>> {
        self.result.as_ref()
    }

    /// Last successful comparison.
    #[must_use]
    pub fn known(&self) -> Option<&Arc<Compared>> {
        self.known.as_ref()
    }

    pub fn choose(&mut self, side: Side, source: SessionSource) {
        self.sources[side as usize] = Some(source);
    }

    pub fn clear(&mut self, side: Side) {
        self.sources[side as usize] = None;
        self.begin();
    }

    pub fn swap(&mut self) {
        self.sources.swap(0, 1);
    }

    /// Begins a comparison and returns its number.
    pub fn begin(&mut self) -> u64 {
        self.result = None;
        self.number += 1;
        self.number
    }

    /// Whether this is the number of the comparison in progress.
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

//! Comparing two sessions.

use std::path::PathBuf;

use crate::model::comparison::{Compared, Side, Source};

pub const COMPARING: &str = "Comparing";

#[derive(Debug, Clone)]
pub enum CompareCommand {
    /// Goes to the comparison; the open session is one of the two unless others are chosen.
    Show,
    /// Asks for a file.
    Ask(Side),
    /// Takes a session.
    Choose(Side, Source),
    /// Takes a file where a session is missing, else as the second.
    Drop(PathBuf),
    /// Chooses again.
    Clear(Side),
    Swap,
    Again,
    /// Asks for the readings of a simulator.
    AskSimulator,
    /// Compares the readings of a simulator with those of the session.
    Simulator(PathBuf),
}

#[derive(Debug)]
pub struct CompareOutcome {
    /// Counts comparisons: an older one that comes late is dropped.
    pub number: u64,
    /// What differs, or one sentence.
    pub result: Result<Box<Compared>, String>,
}

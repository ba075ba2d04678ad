//! Comparing two sessions.

use std::path::PathBuf;

use crate::model::comparison::{Compared, SessionSource, Side};

pub const COMPARING: &str = "Comparing";

#[derive(Debug, Clone)]
pub enum CompareCommand {
    /// Shows the comparison, by default with the open session as one of the two.
    Show,
    /// Asks for a session file.
    Ask(Side),
    /// Chooses a session.
    Choose(Side, SessionSource),
    /// Takes a dropped file: as the missing session, otherwise as the second one.
    Drop(PathBuf),
    /// Removes the choice.
    Clear(Side),
    Swap,
    Again,
    /// Asks for a file with the readings of a simulator.
    AskSimulator,
    /// Compares the readings of a simulator with those of the session.
    Simulator(PathBuf),
}

#[derive(Debug)]
pub struct CompareOutcome {
    /// Number of the comparison; the result of an older one is dropped.
    pub number: u64,
    /// Comparison, or an error message.
    pub result: Result<Box<Compared>, String>,
}

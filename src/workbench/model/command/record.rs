//! The record of a robot.

use std::path::PathBuf;

use crate::model::record::OpenRecord;

pub const READING_RECORD: &str = "Reading the record";

#[derive(Debug, Clone)]
pub enum RecordCommand {
    /// Goes to the record that is open, or to the choice of one.
    Show,
    /// Asks for a folder.
    Ask,
    /// Reads the sessions in a folder.
    Open(PathBuf),
    /// Chooses another folder.
    Close,
    /// Largest tolerable displacement of a pulley (m).
    SetTolerance(f64),
    /// Compares two of its sessions, by their places in the order of time.
    Compare([usize; 2]),
    /// Opens a session of it.
    OpenSession(usize),
    /// Asks where to save the pulleys of all sessions.
    AskSaveTable,
}

#[derive(Debug)]
pub struct RecordOutcome {
    /// Counts openings: an older one that comes late is dropped.
    pub number: u64,
    /// The record, or one sentence.
    pub result: Result<Box<OpenRecord>, String>,
}

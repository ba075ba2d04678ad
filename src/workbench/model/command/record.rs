//! The record of a robot.

use std::path::PathBuf;

use tautline_session::Session;
use tautline_workflow::history::Tolerance;

use crate::model::record::{CheckedPair, OpenRecord};

pub const READING_RECORD: &str = "Reading the record";
pub const CHECKING_HEALTH: &str = "Checking the robot";

#[derive(Debug, Clone)]
pub enum RecordCommand {
    /// Shows the open record, or the choice of one.
    Show,
    /// Asks for a folder.
    Ask,
    /// Reads the sessions in a folder.
    Open(PathBuf),
    /// Chooses another folder.
    Close,
    /// Quantity monitored until the next calibration.
    SetTolerance(Tolerance),
    /// Compares two sessions of the record, by their indices in order of time.
    Compare([usize; 2]),
    /// Opens a session of the record.
    OpenSession(usize),
    /// Checks the second of two sessions of the record against the first.
    Check([usize; 2]),
    /// Begins a session with the poses of a health check of a session of the record, or of the open session.
    PlanCheck(Option<usize>),
    /// Asks for a path to save the pulleys of all sessions to.
    AskSaveTable,
}

#[derive(Debug)]
pub enum RecordOutcome {
    Read {
        /// Number of the opening; the result of an older one is dropped.
        number: u64,
        /// Record, or an error message.
        result: Result<Box<OpenRecord>, String>,
    },
    Checked {
        /// Number of the record.
        number: u64,
        checked: Box<CheckedPair>,
    },
    /// Session with the poses of a health check, or an error message.
    Planned(Result<Box<Session>, String>),
}

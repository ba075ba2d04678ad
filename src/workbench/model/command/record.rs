//! The record of a robot.

use std::path::PathBuf;

use tautline_session::Session;
use tautline_workflow::history::Tolerance;

use crate::model::record::{CheckedPair, OpenRecord};

pub const READING_RECORD: &str = "Reading the record";
pub const CHECKING_HEALTH: &str = "Checking the robot";

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
    /// Quantity monitored until the next calibration.
    SetTolerance(Tolerance),
    /// Compares two of its sessions, by their places in the order of time.
    Compare([usize; 2]),
    /// Opens a session of it.
    OpenSession(usize),
    /// Checks the second of two of its sessions against the first.
    Check([usize; 2]),
    /// Begins a session with the poses of a health check of one of its sessions, or of the open one.
    PlanCheck(Option<usize>),
    /// Asks where to save the pulleys of all sessions.
    AskSaveTable,
}

#[derive(Debug)]
pub enum RecordOutcome {
    Read {
        /// Counts openings: an older one that comes late is dropped.
        number: u64,
        /// The record, or one sentence.
        result: Result<Box<OpenRecord>, String>,
    },
    Checked {
        /// Of the record that was open.
        number: u64,
        checked: Box<CheckedPair>,
    },
    /// A session with the poses of a check, or one sentence.
    Planned(Result<Box<Session>, String>),
}

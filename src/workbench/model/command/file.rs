//! Opening, saving and closing sessions.

use std::path::PathBuf;

use super::RobotCommand;
use tautline_core::effect::EffectSetting;
use tautline_core::robot::Robot;
use tautline_session::{Loaded, Session, UnsavedSession};
use tautline_workflow::importing::Opened;
use tautline_workflow::templates::Template;

#[derive(Debug, Clone)]
pub enum FileCommand {
    /// Opens a session with a simulated robot.
    TryDemo,
    /// Begins a session with a new robot from a template and shows its description.
    New(Template),
    /// Begins a session with a robot that the operator described.
    NewRobot(Box<Robot>),
    AskOpen,
    /// Opens a session, begins one with a robot or a dataset folder, or imports a table.
    Open(PathBuf),
    /// Saves; asks for a path if the session has none.
    Save,
    /// Asks for a path to save to.
    AskSaveAs,
    /// Asks for the path in the file chooser.
    BrowseSave,
    /// Puts the chosen path into the save dialog.
    SetSavePath(PathBuf),
    /// Saves to a path.
    SaveAs(PathBuf),
    /// Begins another series of the open session: the same robot, plan and settings, nothing measured. The model of the
    /// series lacks these effects, which were repaired.
    NewSeries(Vec<EffectSetting>),
    /// Opens a copy of the open session in which the mistakes that the diagnosis found are corrected.
    OpenCorrected,
    Close,
    Quit,
    /// Answers the question about unsaved changes and an armed robot.
    Answer(Answer),
    /// Takes over a session that is open in another window (`true`), opens it read-only (`false`) or not at all
    /// (`None`).
    TakeOver(Option<bool>),
    /// Opens a recoverable session, by its index in the list.
    Recover(usize),
    /// Discards a recoverable session, by its index in the list.
    Discard(usize),
    /// Removes a session from the list of recent ones.
    Forget(PathBuf),
}

/// Action that closes the open session or its connection, perhaps after a question.
#[derive(Debug)]
pub enum PendingAction {
    Open(Box<Opening>),
    Close,
    Quit,
    /// Command that ends the connection, perhaps to begin another one.
    Robot(RobotCommand),
}

impl PendingAction {
    /// Whether the open session must be saved first.
    pub(crate) fn keeps_session(&self) -> bool {
        matches!(self, Self::Open(opening) if opening.origin == Origin::Series)
    }

    /// Whether the session is closed, not only its connection.
    pub(crate) fn ends_session(&self) -> bool {
        !matches!(self, Self::Robot(_))
    }
}

/// Session to be opened.
#[derive(Debug)]
pub struct Opening {
    pub session: Session,
    pub path: Option<PathBuf>,
    pub origin: Origin,
}

/// Origin of a session that is opened.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Origin {
    /// Complete session, from a file for example.
    Complete,
    /// Recovered changes that are in no file yet.
    Recovered,
    /// New robot that has to be described.
    NewRobot,
    /// New series of the open session, which must be saved first.
    Series,
}

/// Outcome of a task with files.
#[derive(Debug)]
pub enum FileOutcome {
    Read {
        path: PathBuf,
        /// Content of the file, or an error message; `None` if reading was cancelled.
        result: Result<Option<Loaded<Opened>>, String>,
    },
    /// Session of the demonstration, or an error message.
    Demo(Result<Box<Session>, String>),
    /// Unsaved sessions of programs that ended without saving, or an error message.
    UnsavedSessions(Result<Vec<UnsavedSession>, String>),
    Saved {
        path: PathBuf,
        /// Number of the session.
        identity: u64,
        revision: u64,
        /// Nothing, or an error message.
        result: Result<(), String>,
    },
}

/// Answer to the question about unsaved changes and an armed robot.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Answer {
    Save,
    /// Continue without the unsaved changes.
    Discard,
    Cancel,
}

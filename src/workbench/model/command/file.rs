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
    /// Begins a session with a new robot, which is then described.
    New(Template),
    /// Begins a session with a robot that the operator described.
    NewRobot(Box<Robot>),
    AskOpen,
    /// Opens a session, begins one with a robot or a dataset folder, or imports a table.
    Open(PathBuf),
    /// Saves; asks for a place if the session has none.
    Save,
    /// Asks for a place to save at.
    AskSaveAs,
    /// Picks the place of a file that is to be saved.
    BrowseSave,
    /// Puts a place that was picked into the dialog that saves.
    SetSavePath(PathBuf),
    /// Saves at a place.
    SaveAs(PathBuf),
    /// Begins another series of the open session: the same robot, plan and settings, nothing measured. The model of the
    /// series lacks these effects, which were repaired.
    NewSeries(Vec<EffectSetting>),
    Close,
    Quit,
    /// Answers what to do about unsaved changes and an armed robot.
    Answer(Answer),
    /// Takes over what is open in another window, or looks at it only; `None` does neither.
    TakeOver(Option<bool>),
    /// Opens an unsaved session that was found, by its place in the list.
    Recover(usize),
    /// Discards an unsaved session that was found, by its place in the list.
    Discard(usize),
    /// Takes a session from the list of recent ones.
    Forget(PathBuf),
}

/// What takes the open session or its controller away, and so may have to wait for an answer.
#[derive(Debug)]
pub enum Leaving {
    Open(Box<Opening>),
    Close,
    Quit,
    /// A command that ends the connection, perhaps for another one.
    Robot(RobotCommand),
}

impl Leaving {
    /// Whether the open session must be in a file before.
    pub(crate) fn keeps_session(&self) -> bool {
        matches!(self, Self::Open(opening) if opening.origin == Origin::Series)
    }

    /// Whether the session is left with its connection.
    pub(crate) fn ends_session(&self) -> bool {
        !matches!(self, Self::Robot(_))
    }
}

/// A session that is to be opened.
#[derive(Debug)]
pub struct Opening {
    pub session: Session,
    pub path: Option<PathBuf>,
    pub origin: Origin,
}

/// Where a session that is opened comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Origin {
    /// A file, or something else that is complete.
    Complete,
    /// Changes that were recovered and are in no file yet.
    Recovered,
    /// A new robot, which has to be described.
    NewRobot,
    /// Another series of the open session, which is kept and so has to be saved.
    Series,
}

/// What a task with files came to.
#[derive(Debug)]
pub enum FileOutcome {
    Read {
        path: PathBuf,
        /// What it is, or one sentence; `None` where reading was stopped.
        result: Result<Option<Loaded<Opened>>, String>,
    },
    /// The demonstration is ready, or one sentence.
    Demo(Result<Box<Session>, String>),
    /// The unsaved sessions of programs that ended without saving, or one sentence.
    UnsavedSessions(Result<Vec<UnsavedSession>, String>),
    Saved {
        path: PathBuf,
        /// Id of the session and the revision that was written.
        state: (u64, u64),
        /// Nothing, or one sentence.
        result: Result<(), String>,
    },
}

/// What to do about unsaved changes and an armed robot.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Answer {
    Save,
    /// Go on, without unsaved changes.
    Discard,
    Cancel,
}

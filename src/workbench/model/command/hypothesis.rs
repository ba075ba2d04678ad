//! Hypotheses of the user, and the gallery of effects.

use std::path::PathBuf;

use tautline_core::robot::Robot;
use tautline_workflow::signature::{Gallery, Signature, Trial};

use super::Answer;

/// Title of the task that fits a hypothesis to the readings.
pub const TRYING: &str = "Fitting the hypothesis";

/// Title of the task that simulates all effects.
pub const DRAWING: &str = "Simulating effects";

#[derive(Debug, Clone)]
pub enum HypothesisCommand {
    /// Shows the editor, with a new hypothesis if there is none yet.
    Show,
    /// Begins a new hypothesis.
    New,
    /// Begins with a text, such as that of a pattern or an effect.
    Begin(String),
    /// Asks for a hypothesis file.
    AskOpen,
    Open(PathBuf),
    SetText(String),
    /// Computes what it does to the residuals.
    Try,
    /// Shows one of the targets.
    ChoosePlacement(usize),
    /// Puts it into the session.
    SaveInSession,
    /// Takes a hypothesis out of the session, by its identifier.
    Remove(String),
    /// Asks for the file to save it in.
    AskSave,
    Save(PathBuf),
    /// Puts it into the session and asks the model doctor.
    AskDoctor,
    /// Answers what becomes of an unsaved text.
    Answer(Answer),
    /// Simulates all effects on the robot.
    DrawGallery,
    /// Asks where to save the gallery.
    AskSaveGallery,
    SaveGallery(PathBuf),
}

#[derive(Debug)]
pub enum HypothesisOutcome {
    /// What a text does to the residuals of inputs of this number; `None` if it was stopped.
    Tried {
        of: (String, Option<u64>),
        result: Result<Option<Previewed>, String>,
    },
    /// The text of a file, or one sentence.
    Read(PathBuf, Result<String, String>),
    /// A text was written to a file, or one sentence.
    Saved {
        path: PathBuf,
        text: String,
        result: Result<(), String>,
    },
    /// The gallery of a robot, or one sentence; `None` if it was stopped.
    Gallery(Box<Robot>, Result<Option<Box<Gallery>>, String>),
}

/// What a hypothesis does to the residuals.
#[derive(Debug, Clone)]
pub enum Previewed {
    /// Fitted to the readings of the session.
    Measured(Trial),
    /// Simulated at typical size, where nothing is measured.
    Simulated(Box<Signature>),
}

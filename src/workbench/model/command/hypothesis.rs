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
    /// Shows the editor, with a new hypothesis if there is none.
    Show,
    /// Begins a new hypothesis.
    New,
    /// Begins with a text, such as that of a pattern or an effect.
    Begin(String),
    /// Asks for a hypothesis file.
    AskOpen,
    Open(PathBuf),
    SetText(String),
    /// Computes the effect of the hypothesis on the residuals.
    Try,
    /// Shows one of the targets.
    ChoosePlacement(usize),
    /// Adds the hypothesis to the session.
    SaveInSession,
    /// Removes a hypothesis, by its identifier, from the session.
    Remove(String),
    /// Asks for a file to save the hypothesis to.
    AskSave,
    Save(PathBuf),
    /// Adds the hypothesis to the session and runs the model doctor.
    AskDoctor,
    /// Answers the question about an unsaved text.
    Answer(Answer),
    /// Simulates all effects on the robot.
    DrawGallery,
    /// Asks where to save the gallery.
    AskSaveGallery,
    SaveGallery(PathBuf),
}

#[derive(Debug)]
pub enum HypothesisOutcome {
    /// Effect of a text on the residuals of the inputs of this number; `None` if it was cancelled.
    Tried {
        of: (String, Option<u64>),
        result: Result<Option<PreviewResult>, String>,
    },
    /// Text of a file, or an error message.
    Read(PathBuf, Result<String, String>),
    /// Result of writing a text to a file.
    Saved {
        path: PathBuf,
        text: String,
        result: Result<(), String>,
    },
    /// Gallery of a robot, or an error message; `None` if it was cancelled.
    Gallery(Box<Robot>, Result<Option<Box<Gallery>>, String>),
}

/// Effect of a hypothesis on the residuals.
#[derive(Debug, Clone)]
pub enum PreviewResult {
    /// Fitted to the readings of the session.
    Measured(Trial),
    /// Simulated at typical size, without measurements.
    Simulated(Box<Signature>),
}

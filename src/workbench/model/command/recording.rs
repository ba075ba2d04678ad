//! Importing files of other programs.

use std::path::PathBuf;

use tautline_channels::Source;
use tautline_core::robot::Robot;
use tautline_import::{AlignedClock, Recipe};
use tautline_session::Loaded;

use crate::model::importing::{ChannelPlace, Cut};

/// Title of the task that reads files of other programs.
pub const READING: &str = "Reading";

pub const CUTTING: &str = "Cutting into poses";

/// Title of the task that aligns the clocks.
pub const ALIGNING: &str = "Aligning the clocks";

#[derive(Debug, Clone)]
pub enum RecordingCommand {
    /// Shows the import.
    Show,
    /// Returns to the import of the session's poses to correct its recipe.
    Correct,
    /// Asks for a file.
    Ask,
    /// Reads a file or folder as one of another program, even if it looks like a session.
    Read(PathBuf),
    /// Removes a source, by its index.
    Remove(usize),
    /// Uses a robot for files that were read before there was one.
    UseRobot(Box<Robot>),
    /// Replaces the recipe; the text names the change, the flag is set while a slider is dragged.
    Change(Box<Recipe>, String, bool),
    /// Applies a suggestion, by its index.
    Apply(usize),
    /// Estimates offset and drift of the clocks.
    AlignClocks,
    ShowChannel(ChannelPlace),
    /// Asks for a recipe file.
    AskRecipe,
    UseRecipe(PathBuf),
    AskSaveRecipe,
    SaveRecipe(PathBuf),
    /// Adds the poses to the session, or to a new one if the session has poses already.
    Finish,
    /// Discards the import.
    Discard,
}

/// Outcome of a task of an import.
#[derive(Debug)]
pub enum RecordingOutcome {
    /// Files that were read, or an error message; `None` if it was cancelled.
    Read(Result<Option<Loaded<Vec<Source>>>, String>),
    Recipe(PathBuf, Result<Box<Loaded<Recipe>>, String>),
    Cut(Box<Cut>),
    /// Revision of the draft and the recipe with the aligned clocks; or an error message.
    Aligned(u64, Result<(Box<Recipe>, Vec<AlignedClock>), String>),
}

//! Importing files of other programs.

use std::path::PathBuf;

use tautline_core::robot::Robot;
use tautline_import::{AlignedClock, Recipe, Source};
use tautline_session::Loaded;

use crate::model::importing::{ChannelPlace, Cut};

/// Title of reading files of other programs.
pub const READING: &str = "Reading";

pub const CUTTING: &str = "Cutting into poses";

/// Title of finding clocks.
pub const ALIGNING: &str = "Aligning the clocks";

#[derive(Debug, Clone)]
pub enum RecordingCommand {
    /// Goes to where files are imported.
    Show,
    /// Goes back to the import of the session's poses, to correct its recipe.
    Correct,
    /// Asks for a file.
    Ask,
    /// Reads a file or folder as one of another program, whatever it seems to be.
    Read(PathBuf),
    /// Takes a source out, by its index.
    Remove(usize),
    /// Begins with a robot, for files that wait for one.
    UseRobot(Box<Robot>),
    /// Takes a recipe; the text names the change; the flag is set while a slider is dragged.
    Change(Box<Recipe>, String, bool),
    /// Takes up a suggestion, by its index.
    Apply(usize),
    /// Finds offset and drift of the clocks.
    AlignClocks,
    ShowChannel(ChannelPlace),
    /// Asks for the file of a recipe.
    AskRecipe,
    UseRecipe(PathBuf),
    AskSaveRecipe,
    SaveRecipe(PathBuf),
    /// Puts the poses into the session, or into a new one where it has poses already.
    Finish,
    /// Forgets the files.
    Discard,
}

/// What a task for an import came to.
#[derive(Debug)]
pub enum RecordingOutcome {
    /// Files were read; `None` where that was stopped.
    Read(Result<Option<Loaded<Vec<Source>>>, String>),
    Recipe(PathBuf, Result<Box<Loaded<Recipe>>, String>),
    Cut(Box<Cut>),
    /// Clocks were found, with the revision of the draft they are of and the recipe that has them; or one sentence.
    Aligned(u64, Result<(Box<Recipe>, Vec<AlignedClock>), String>),
}

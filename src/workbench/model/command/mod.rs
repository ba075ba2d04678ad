//! Everything the operator can make the program do, in one place: menus, shortcuts, the command palette and buttons
//! all send these, and each kind has one handler in `commands/`.

mod compare;
mod file;
mod identification;
mod import;
mod plot;
mod report;
mod robot;
mod setup;
mod view;

pub use compare::{COMPARING, CompareCommand, CompareOutcome};
pub use file::{Answer, FileCommand, FileOutcome, Leaving, Opening, Purpose};
pub use identification::{
    DIAGNOSING, DiagnosisResult, IDENTIFYING, IdentificationCommand, IdentificationOutcome,
};
pub use import::{ImportCommand, ImportOutcome};
pub use plot::{Format, PlotCommand, PlotOutcome};
pub use report::{ReportCommand, ReportDraft, ReportOutcome};
pub use robot::{EXPECTING, Export, PLANNING, RobotCommand, RobotOutcome};
pub use setup::{CHECKING, Setup, SetupOutcome};
pub use view::{PoseStep, ViewCommand};

use super::caught_panic::CaughtPanic;
use super::edit::Edit;

/// What is to be done.
#[derive(Debug, Clone)]
pub enum Command {
    /// Opening, saving, closing.
    File(FileCommand),
    /// Tables of phases 1 and 2.
    Import(ImportCommand),
    /// A change that can be undone.
    Edit(Edit),
    /// Undoes the last edit.
    Undo,
    /// Does the last undone edit again.
    Redo,
    /// What is shown.
    View(ViewCommand),
    /// Identification and diagnosis.
    Identification(IdentificationCommand),
    /// Preparing and saving plots.
    Plot(PlotCommand),
    /// Measuring, adjusting, verifying.
    Robot(RobotCommand),
    /// The report.
    Report(ReportCommand),
    /// Two sessions side by side.
    Compare(CompareCommand),
}

/// What a task came to.
#[derive(Debug)]
pub enum Outcome {
    /// Of a task with files.
    File(FileOutcome),
    /// Of an import.
    Import(ImportOutcome),
    /// Of identification or diagnosis.
    Identification(IdentificationOutcome),
    /// Of preparing or saving plots.
    Plot(PlotOutcome),
    /// Of planning, or of a file of phases 3 and 5.
    Robot(RobotOutcome),
    /// Of a task with the report.
    Report(ReportOutcome),
    /// Of comparing two sessions.
    Compare(CompareOutcome),
    /// The task broke down.
    Panicked {
        /// Its title.
        task: String,
        /// What it said.
        caught_panic: CaughtPanic,
    },
}

macro_rules! from {
    ($($kind:ident => $whole:ident::$variant:ident),* $(,)?) => {
        $(impl From<$kind> for $whole {
            fn from(value: $kind) -> Self {
                Self::$variant(value)
            }
        })*
    };
}

from!(
    FileCommand => Command::File,
    ImportCommand => Command::Import,
    Edit => Command::Edit,
    ViewCommand => Command::View,
    IdentificationCommand => Command::Identification,
    PlotCommand => Command::Plot,
    ReportCommand => Command::Report,
    CompareCommand => Command::Compare,
    FileOutcome => Outcome::File,
    ImportOutcome => Outcome::Import,
    IdentificationOutcome => Outcome::Identification,
    PlotOutcome => Outcome::Plot,
    RobotCommand => Command::Robot,
    RobotOutcome => Outcome::Robot,
    ReportOutcome => Outcome::Report,
    CompareOutcome => Outcome::Compare,
);

/// Commands that were given in this frame; they are carried out after it was drawn.
#[derive(Debug, Default)]
pub struct Outbox {
    commands: Vec<Command>,
}

impl Outbox {
    /// Gives a command.
    pub fn send(&mut self, command: impl Into<Command>) {
        self.commands.push(command.into());
    }

    /// Takes all that were given.
    pub fn take(&mut self) -> Vec<Command> {
        std::mem::take(&mut self.commands)
    }
}

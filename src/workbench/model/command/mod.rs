//! Everything the operator can make the program do, in one place: menus, shortcuts, the command palette and buttons
//! all send these, and each kind has one handler in `commands/`.

mod compare;
mod file;
pub(crate) mod file_choice;
mod hypothesis;
mod identification;
mod import;
mod plot;
mod record;
mod recording;
mod report;
mod robot;
mod setup;
mod study;
mod view;

pub use compare::{COMPARING, CompareCommand, CompareOutcome};
pub use file::{Answer, FileCommand, FileOutcome, Leaving, Opening, Origin};
pub use hypothesis::{DRAWING, HypothesisCommand, HypothesisOutcome, Previewed, TRYING};
pub use identification::{
    DIAGNOSING, DiagnosisResult, FORMULAS, IDENTIFYING, IdentificationCommand,
    IdentificationOutcome, READINESS, Readiness,
};
pub use import::{ImportCommand, ImportOutcome};
pub use plot::{Format, PlotCommand, PlotFile, PlotPicture};
pub use record::{CHECKING_HEALTH, READING_RECORD, RecordCommand, RecordOutcome};
pub use recording::{ALIGNING, CUTTING, READING, RecordingCommand, RecordingOutcome};
pub use report::{ReportCommand, ReportDraft, WorkshopInstrument};
pub(crate) use robot::STOP;
pub use robot::{
    CorrectedFile, EXPECTING, Export, FileCorrection, PLANNING, PlanOutcome, PlanOutlook,
    RobotCommand, WriteDraft,
};
pub use setup::{CHECKING, Setup, SetupOutcome, UserFile};
pub use study::{AskedRobot, SIMULATING, StudyCommand};
pub use view::{PoseStep, ViewCommand};

use std::path::PathBuf;

use super::caught_panic::CaughtPanic;
use super::comparison::SimulatorComparison;
use super::edit::Edit;
use super::link::LinkRequest;
use super::plot_preparation::Preparation;
use file_choice::FileChoice;

#[derive(Debug, Clone)]
pub enum Command {
    File(FileCommand),
    /// Tables of phases 1 and 2.
    Import(ImportCommand),
    /// Files of other programs.
    Recording(RecordingCommand),
    /// A change that can be undone.
    Edit(Edit),
    Undo,
    Redo,
    View(ViewCommand),
    Identification(IdentificationCommand),
    Plot(PlotCommand),
    Robot(RobotCommand),
    Report(ReportCommand),
    Compare(CompareCommand),
    Record(RecordCommand),
    /// Hypotheses of the user, and the gallery of effects.
    Hypothesis(HypothesisCommand),
    /// Simulating what the expected covariance answers.
    Study(StudyCommand),
    /// Asks the tasks of this title to end.
    CancelTask(&'static str),
    /// Shows an error in a field.
    Refuse(String),
}

impl Command {
    /// Whether it changes the open session or works with its robot, other than stopping it.
    pub(crate) fn acts_on_session(&self) -> bool {
        match self {
            Self::Edit(_) | Self::Undo | Self::Redo | Self::Import(_) | Self::Recording(_) => true,
            Self::Robot(command) => !matches!(command, RobotCommand::Stop | RobotCommand::Expect),
            _ => false,
        }
    }
}

#[derive(Debug)]
pub enum Outcome {
    /// Of a task with files.
    File(FileOutcome),
    /// Of reading a table.
    Import(ImportOutcome),
    /// Of files of other programs.
    Recording(RecordingOutcome),
    /// Of identification or diagnosis.
    Identification(IdentificationOutcome),
    /// Of computing what plots show.
    Prepared(Box<Preparation>),
    /// Of planning poses.
    Plan(PlanOutcome),
    /// Of taking identified values into a file.
    Corrected(FileCorrection),
    /// Of looking symbols up or reading their names.
    Setup(SetupOutcome),
    /// Of comparing two sessions.
    Compare(CompareOutcome),
    /// Of comparing a simulator with the machine.
    Simulator(SimulatorComparison),
    /// Of reading the record of a robot.
    Record(RecordOutcome),
    /// Of hypotheses and the gallery.
    Hypothesis(HypothesisOutcome),
    /// What to do with the file that was picked in a dialog of the desktop; `None` if that was cancelled.
    Picked(Option<Box<Command>>),
    /// The desktop has no dialog for a file that is asked for.
    NoFileDialog(FileChoice),
    /// A file was written, perhaps with a warning; or one sentence.
    Written(PathBuf, Result<Option<String>, String>),
    Panicked {
        task: String,
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
    RecordingCommand => Command::Recording,
    Edit => Command::Edit,
    ViewCommand => Command::View,
    IdentificationCommand => Command::Identification,
    PlotCommand => Command::Plot,
    ReportCommand => Command::Report,
    CompareCommand => Command::Compare,
    RecordCommand => Command::Record,
    HypothesisCommand => Command::Hypothesis,
    StudyCommand => Command::Study,
    FileOutcome => Outcome::File,
    ImportOutcome => Outcome::Import,
    RecordingOutcome => Outcome::Recording,
    IdentificationOutcome => Outcome::Identification,
    RobotCommand => Command::Robot,
    PlanOutcome => Outcome::Plan,
    FileCorrection => Outcome::Corrected,
    SetupOutcome => Outcome::Setup,
    CompareOutcome => Outcome::Compare,
    SimulatorComparison => Outcome::Simulator,
    RecordOutcome => Outcome::Record,
    HypothesisOutcome => Outcome::Hypothesis,
);

impl From<LinkRequest> for Command {
    fn from(request: LinkRequest) -> Self {
        Self::Robot(RobotCommand::Link(request))
    }
}

/// Commands that were given in this frame; they are carried out after it was drawn.
#[derive(Debug, Default)]
pub struct Outbox {
    commands: Vec<Command>,
}

impl Outbox {
    pub fn send(&mut self, command: impl Into<Command>) {
        self.commands.push(command.into());
    }

    pub fn take(&mut self) -> Vec<Command> {
        std::mem::take(&mut self.commands)
    }
}

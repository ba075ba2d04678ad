//! All actions of the operator: menus, shortcuts, the command palette and buttons send these commands, and each kind
//! has one handler in `commands/`.

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
pub use file::{Answer, FileCommand, FileOutcome, Opening, Origin, PendingAction};
pub use hypothesis::{DRAWING, HypothesisCommand, HypothesisOutcome, PreviewResult, TRYING};
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
    /// Study of a question of *Which sensor?*.
    Study(StudyCommand),
    /// Cancels all tasks of this title.
    CancelTask(&'static str),
    /// Shows an error of an input field.
    Refuse(String),
}

impl Command {
    /// Whether the command changes the open session or uses its robot, other than to stop it.
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
    /// Task with files.
    File(FileOutcome),
    /// Reading of a table.
    Import(ImportOutcome),
    /// Files of other programs.
    Recording(RecordingOutcome),
    /// Identification or diagnosis.
    Identification(IdentificationOutcome),
    /// Computations for plots.
    Prepared(Box<Preparation>),
    /// Planning of poses.
    Plan(PlanOutcome),
    /// Correction of a firmware or simulator file.
    Corrected(FileCorrection),
    /// Check of symbols, or import of their names.
    Setup(SetupOutcome),
    /// Comparison of two sessions.
    Compare(CompareOutcome),
    /// Comparison of a simulator with the machine.
    Simulator(SimulatorComparison),
    /// Reading of a robot's record.
    Record(RecordOutcome),
    /// Hypotheses and the gallery.
    Hypothesis(HypothesisOutcome),
    /// Command for the file chosen in a dialog of the desktop; `None` if the dialog was cancelled.
    Picked(Option<Box<Command>>),
    /// The desktop has no file dialog.
    NoFileDialog(FileChoice),
    /// A file was written, perhaps with a warning; or an error message.
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

/// Commands given in this frame, carried out after it is drawn.
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

//! Planning and measuring poses, the controller, adjustment and verification.

use std::path::PathBuf;
use std::sync::Arc;

use egui::{Key, KeyboardShortcut, Modifiers};
use tautline_session::{PlannedPose, Stage};

use super::Setup;
use crate::model::OpenSession;
use crate::model::link::LinkRequest;
use tautline_workflow::adjusting::{Doubt, Purpose, Review};
use tautline_workflow::exporting::DialectText;
use tautline_workflow::planning::PlanSummary;

pub const PLANNING: &str = "Planning poses";

/// Title of the task that computes what to expect of a plan.
pub const EXPECTING: &str = "Predicting the accuracy of the plan";

/// The key that stops the robot. It is no letter and needs no other key, so that it works whatever has the focus.
pub(crate) const STOP: KeyboardShortcut = KeyboardShortcut::new(Modifiers::NONE, Key::F12);

/// Plan, controller and writing.
#[derive(Debug, Clone)]
pub enum RobotCommand {
    Plan(usize),
    /// Computes what to expect of the plan that there is.
    Expect,
    /// Takes a pose from the plan.
    RemovePlanned(i64),
    /// Adds the pose that is commanded now to the plan.
    AddCurrent,
    /// Opens the connection dialog, or does what it asks for.
    Setup(Setup),
    /// Connects to the controller of the session's settings.
    Connect,
    /// Connects to the simulated robot of the session and arms it; any other controller is only connected.
    ConnectAndArm,
    /// Goes to the thread of the controller as it is.
    Link(LinkRequest),
    /// Allows motion and writing.
    Arm,
    /// Switches readings on or off while the controller is idle.
    PollWhenIdle(bool),
    /// Sets the time lapse of a simulated robot.
    Speed(f64),
    /// Measures the planned poses that are not measured yet.
    Start,
    /// Measures a pose again.
    Repeat(i64),
    /// Ends the current operation and stops the platform.
    Stop,
    /// Tries again to save a measured pose that could not be saved.
    RetrySave,
    /// Measures test poses and paths with the external instrument.
    Verify(Stage),
    /// Takes the imported check as a run.
    TakeCheck(Stage),
    /// Asks whether the identified values are to be written to the controller, and who writes them.
    Write,
    WriteValues(Vec<(String, f64)>, Purpose),
    /// Writes the values of the open question, or does not.
    ConfirmWrite(bool),
    /// Accepts the robot on the result of the last verification.
    Accept,
    /// Writes the values that were there before the last adjustment.
    RollBack,
    /// Writes a file; asks for its place.
    AskExport(Export),
    /// Writes a file.
    Export(Export, PathBuf),
    /// Asks for a file of a firmware or simulator.
    AskFirmware,
    /// Takes the identified values into the text of such a file.
    Firmware(PathBuf),
    Reveal,
}

impl RobotCommand {
    /// Whether a connection ends with it.
    pub(crate) fn disconnects(&self) -> bool {
        matches!(
            self,
            Self::Connect | Self::ConnectAndArm | Self::Link(LinkRequest::Disconnect)
        )
    }
}

/// The identified values in a file of a firmware or simulator.
#[derive(Debug)]
pub struct FileCorrection {
    /// Number of the inputs of the session from which they were identified.
    pub inputs: u64,
    pub file: String,
    /// The corrected text, or one sentence.
    pub result: Result<Box<CorrectedFile>, String>,
}

/// A corrected text.
#[derive(Debug)]
pub struct CorrectedFile {
    pub written: DialectText,
    /// The lines that change, to be pasted.
    pub lines: String,
}

/// Values that are to be written, while that is to be confirmed.
#[derive(Debug, Clone, Default)]
pub struct WriteDraft {
    /// What is shown and written; nothing if there is another one by then.
    pub review: Arc<Review>,
    /// Reasons not to write.
    pub doubts: Vec<Doubt>,
    /// Operator who writes them.
    pub operator: String,
}

/// What to expect of planned poses.
#[derive(Debug)]
pub struct PlanOutlook {
    pub session_id: u64,
    /// The poses; none where planning them failed.
    pub plan: Vec<PlannedPose>,
    /// What to expect of them, or one sentence.
    pub result: Result<PlanSummary, String>,
}

impl PlanOutlook {
    /// Whether the session still has this plan.
    #[must_use]
    pub fn is_of(&self, open: &OpenSession) -> bool {
        let plan = &open.session().plan;
        let has_plan = match &self.result {
            Ok(outlook) => outlook.poses.iter().all(|pose| plan.contains(pose)),
            Err(_) => self.plan == *plan,
        };
        has_plan && self.session_id == open.id()
    }
}

/// What planning came to.
#[derive(Debug)]
pub enum PlanOutcome {
    Planned(Box<PlanOutlook>),
    /// The plan that was there already was looked at.
    Expected(Box<PlanOutlook>),
}

/// What is written to a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Export {
    /// The poses to measure, as a table.
    Plan,
    /// Parameters of the controller and identified ones, as a table.
    Differences,
    /// Identified parameters as constants in Structured Text.
    StructuredText,
    /// The last verification, as a table.
    Check,
}

impl Export {
    /// Name that is suggested for the file.
    #[must_use]
    pub fn file_name(self) -> &'static str {
        match self {
            Self::Plan => "plan.csv",
            Self::Differences => "adjustment.csv",
            Self::StructuredText => "parameters.st",
            Self::Check => "check.csv",
        }
    }
}

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

/// Title of the task that predicts the accuracy of a plan.
pub const EXPECTING: &str = "Predicting the accuracy of the plan";

/// Key that stops the robot. It is neither a letter nor a combination, so that it works with any keyboard focus.
pub(crate) const STOP: KeyboardShortcut = KeyboardShortcut::new(Modifiers::NONE, Key::F12);

/// Plan, controller and writing.
#[derive(Debug, Clone)]
pub enum RobotCommand {
    Plan(usize),
    /// Predicts the accuracy of the present plan.
    Expect,
    /// Removes a pose from the plan.
    RemovePlanned(i64),
    /// Adds the commanded pose to the plan.
    AddCurrent,
    /// Opens the connection dialog, or carries out its request.
    Setup(Setup),
    /// Connects to the controller of the session.
    Connect,
    /// Connects to the simulated robot of the session and arms it; another controller is connected but not armed.
    ConnectAndArm,
    /// Passed on to the thread of the controller.
    Link(LinkRequest),
    /// Enables motion and writing.
    Arm,
    /// Switches polling of the readings while the controller is idle.
    PollWhenIdle(bool),
    /// Sets the speed of time of a simulated robot.
    Speed(f64),
    /// Measures the planned poses that are not measured yet.
    Start,
    /// Measures a pose again.
    Repeat(i64),
    /// Ends the current operation and stops the platform.
    Stop,
    /// Retries to store a measured pose.
    RetrySave,
    /// Measures test poses and paths with the external instrument.
    Verify(Stage),
    /// Takes the imported check as a verification run.
    TakeCheck(Stage),
    /// Asks for confirmation before the identified values are written to the controller, and for the operator's name.
    Write,
    WriteValues(Vec<(String, f64)>, Purpose),
    /// Answers the question whether to write.
    ConfirmWrite(bool),
    /// Accepts the robot on the result of the last verification.
    Accept,
    /// Restores the values from before the last adjustment.
    RollBack,
    /// Asks for a path to export to.
    AskExport(Export),
    /// Exports a file.
    Export(Export, PathBuf),
    /// Asks for a file of a firmware or simulator.
    AskFirmware,
    /// Replaces the values in the text of such a file by the identified ones.
    Firmware(PathBuf),
    Reveal,
}

impl RobotCommand {
    /// Whether the command ends the present connection; connecting replaces it.
    pub(crate) fn disconnects(&self) -> bool {
        matches!(
            self,
            Self::Connect | Self::ConnectAndArm | Self::Link(LinkRequest::Disconnect)
        )
    }
}

/// Correction of a firmware or simulator file by the identified values.
#[derive(Debug)]
pub struct FileCorrection {
    /// Number of the session's inputs behind the identified values.
    pub inputs: u64,
    pub file: String,
    /// Corrected text, or an error message.
    pub result: Result<Box<CorrectedFile>, String>,
}

/// Corrected text of a firmware or simulator file.
#[derive(Debug)]
pub struct CorrectedFile {
    pub written: DialectText,
    /// Changed lines, for pasting.
    pub lines: String,
}

/// Values to be written, until they are confirmed.
#[derive(Debug, Clone, Default)]
pub struct WriteDraft {
    /// Values that are shown and written; nothing is written if they have changed by then.
    pub review: Arc<Review>,
    /// Reasons against writing.
    pub doubts: Vec<Doubt>,
    /// Name of the operator.
    pub operator: String,
}

/// Predicted accuracy of planned poses.
#[derive(Debug)]
pub struct PlanOutlook {
    pub session_id: u64,
    /// Planned poses, if planning them failed.
    pub plan: Vec<PlannedPose>,
    /// Prediction, or an error message.
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

/// Outcome of planning.
#[derive(Debug)]
pub enum PlanOutcome {
    Planned(Box<PlanOutlook>),
    /// Prediction for the plan that the session had already.
    Expected(Box<PlanOutlook>),
}

/// File to be exported.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Export {
    /// Table of the poses to measure.
    Plan,
    /// Table of the controller's parameters and the identified ones.
    Differences,
    /// Identified parameters as constants in Structured Text.
    StructuredText,
    /// Table of the last verification.
    Check,
}

impl Export {
    /// Suggested file name.
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

//! Commands, events and status between the window and the thread that owns the controller.

use std::sync::Arc;
use std::time::Instant;

use tautline_core::geometry::{Pose, Vec3};
use tautline_core::robot::Robot;
use tautline_link::adjusting::{Adjustment, ControllerValues};
use tautline_link::measuring::{Rates, Warning};
use tautline_link::verifying::CheckTarget;
use tautline_link::{ControllerState, LinkProtection, ParameterInfo, Sample, UntrustedServer};
use tautline_session::{CheckPose, CheckRow, MeasuredPose, Stage};

use tautline_workflow::adjusting::Purpose;
use tautline_workflow::controllers::ConnectionSetup;

/// Request of the operator that is passed to the thread of the controller unchanged.
#[derive(Debug, Clone)]
pub enum LinkRequest {
    /// Ends the connection; a run ends with it.
    Disconnect,
    /// Disables motion and writing.
    Disarm,
    Pause,
    Resume,
    /// Skips the current pose of the run.
    Skip,
    /// Laser distance (m) typed for the pose of this label; `None` if the laser has no return.
    LaserDistance(i64, Option<f64>),
    /// Pose typed for the target of this number, from 1, of the verification.
    TypedPose(usize, CheckPose),
    /// Tries to reconnect now.
    TryNow,
    ReadParameters,
}

impl From<LinkRequest> for DriverCommand {
    fn from(request: LinkRequest) -> Self {
        Self::Requested(request)
    }
}

pub enum DriverCommand {
    /// Connects for the session of this id.
    Connect(Box<ConnectionSetup>, u64),
    Requested(LinkRequest),
    /// Enables motion and writing.
    Arm,
    /// Switches polling of the sensors between operations.
    PollWhenIdle(bool),
    Speed(f64),
    Measure(Box<MeasuringRequest>),
    /// Adds a pose to an open-ended run.
    Add(i64, Pose),
    /// Ends an open-ended run after its present poses.
    Close,
    /// Measures the pose of this label again, next.
    Repeat(i64),
    /// Aborts the operation and stops the platform.
    Abort,
    /// Confirms that the pose of this label is stored.
    Stored(i64),
    /// Verifies at targets, some of which are measured already.
    Verify(Vec<CheckTarget>, Stage, Vec<CheckRow>),
    /// Writes new values, unless the controller no longer holds the old ones.
    Write {
        /// Values on the controller before writing.
        old: Vec<(String, f64)>,
        new: Vec<(String, f64)>,
        purpose: Purpose,
    },
    /// Compares the controller with the old and new values after an interrupted write; if it is armed and holds a
    /// mixture, the old values are restored.
    Settle {
        /// Values before writing.
        old: Vec<(String, f64)>,
        new: Vec<(String, f64)>,
    },
}

pub struct MeasuringRequest {
    /// Labels and poses.
    pub plan: Vec<(i64, Pose)>,
    /// Labels that are measured already.
    pub measured: Vec<i64>,
    /// Model that predicts the readings.
    pub model: Robot,
    /// Whether poses are added one by one, so that the run does not end when all are measured.
    pub is_open_ended: bool,
}

/// Deviation of a new pose from its prediction.
#[derive(Debug, Clone, PartialEq)]
pub struct PoseDeviation {
    pub label: i64,
    /// Predicted minus measured length of each cable (m).
    pub lengths_m: Vec<f64>,
    /// Predicted minus measured laser distance (m).
    pub laser_m: Option<f64>,
}

/// Event of the driver thread.
#[derive(Debug)]
pub enum DriverEvent {
    Connected {
        identity: String,
        protection: Option<LinkProtection>,
        parameters: Vec<ParameterInfo>,
        rig: Box<ConnectionSetup>,
        session_id: u64,
    },
    /// The connection has ended; with the reason, unless requested.
    Disconnected(Option<String>),
    /// The connection is lost and is being re-established; with the reason.
    Lost(String),
    /// The connection is re-established, not armed; with the values of the controller.
    Regained(Vec<ParameterInfo>),
    /// Controller values before the first pose of a run.
    ValuesAtStart(Vec<ParameterInfo>),
    /// Controller values after the run.
    ValuesAtEnd(Vec<ParameterInfo>),
    /// The controller moves to a pose.
    Commanded(i64),
    /// A pose is measured and must be stored.
    Measured(Box<MeasuredPose>, Option<PoseDeviation>),
    Warning(Warning),
    Skipped(i64),
    /// The run is paused; with the reason.
    Paused(String),
    Resumed,
    /// The run is complete, or ended early for a reason.
    RunEnded(Result<(), String>),
    /// The run ended because the controller was restarted; it cannot be continued.
    RunRestarted(String),
    /// A verification ended, with its rows and the reason if it ended early.
    Verified(Stage, Vec<CheckRow>, Result<(), String>),
    Parameters(Vec<ParameterInfo>),
    /// Result of writing, with the controller values afterwards.
    Written {
        values: Vec<(String, f64)>,
        purpose: Purpose,
        /// Adjustment, or the reason why nothing was written.
        result: Result<Box<Adjustment>, String>,
        /// Values read back; `None` if reading failed.
        holds: Option<Vec<ParameterInfo>>,
    },
    /// Result of settling an interrupted write, with the controller values afterwards.
    Settled {
        /// Values found on the controller.
        found: ControllerValues,
        adjustment: Box<Adjustment>,
        /// Values read back; `None` if reading failed.
        holds: Option<Vec<ParameterInfo>>,
    },
    /// A request was refused; with the reason.
    Refused(String),
    /// No connection, because the certificate of the server is not trusted.
    Untrusted(Box<UntrustedServer>),
}

/// Current step of a run.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum RunStep {
    #[default]
    Nothing,
    Moving,
    /// Waiting for the platform to stand still.
    Settling {
        /// Rates of change; `None` before there are enough samples.
        rates: Option<Rates>,
        /// Limits for standstill.
        limits: Rates,
        /// Minimum remaining time (s).
        remaining_s: f64,
    },
    /// Waiting for the operator to type the laser distance.
    Asking {
        label: i64,
        /// Predicted distance (m), if known.
        expected_m: Option<f64>,
    },
    Sampling {
        taken: usize,
        of: usize,
    },
    Verifying {
        done: usize,
        /// Number of targets.
        of: usize,
    },
    /// Waiting for the operator to type the pose at a target.
    Locating {
        /// Number of the target, from 1.
        number: usize,
        /// Number of targets.
        of: usize,
    },
}

/// Lost connection that is being re-established.
#[derive(Debug, Clone, PartialEq)]
pub struct LostConnection {
    pub why: String,
    /// Time of the next attempt.
    pub due: Instant,
}

/// Present state of the controller and its run.
#[derive(Debug, Clone, Default)]
pub struct LiveState {
    pub state: Option<ControllerState>,
    /// Lost connection that is being re-established.
    pub lost: Option<LostConnection>,
    pub sample: Option<Sample>,
    /// Pose of the platform computed from the sample.
    pub pose: Option<Pose>,
    pub doing: RunStep,
    /// Poses still to be measured.
    pub remaining: usize,
    /// Remaining time of a verification (s, clock of the controller); `None` before the second target.
    pub remaining_s: Option<f64>,
}

/// Pose, trail and tensions of the platform during an operation and after a stop.
#[derive(Debug, Clone, PartialEq)]
pub struct LivePlatform {
    /// Pose computed from the readings.
    pub pose: Pose,
    /// Positions since the operation began (m).
    pub trail: Arc<Vec<Vec3>>,
    /// Whether the platform rests after a stopped operation.
    pub is_stopped: bool,
    /// Tension of each cable (N); empty or NaN if unknown.
    pub tensions_n: Vec<f64>,
}

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

/// What the operator asks the thread of the controller for, with nothing else to be done.
#[derive(Debug, Clone)]
pub enum LinkRequest {
    /// Ends the connection; a run ends with it.
    Disconnect,
    /// Forbids motion and writing.
    Disarm,
    Pause,
    Resume,
    /// The run leaves out the pose under way.
    Skip,
    /// The laser distance (m) at the pose of this label as the operator reads it; `None`: it has no return.
    LaserDistance(i64, Option<f64>),
    /// The pose at the target of this number of the verification, from 1, as the operator reads it.
    TypedPose(usize, CheckPose),
    /// Tries to reach a lost controller now.
    TryNow,
    ReadParameters,
}

impl From<LinkRequest> for DriverCommand {
    fn from(request: LinkRequest) -> Self {
        Self::Requested(request)
    }
}

pub enum DriverCommand {
    /// Connects, for the session of this id.
    Connect(Box<ConnectionSetup>, u64),
    Requested(LinkRequest),
    /// Allows motion and writing.
    Arm,
    /// Whether the sensors are read without an operation.
    PollWhenIdle(bool),
    Speed(f64),
    Measure(Box<MeasuringRequest>),
    /// An open-ended run measures this pose, too.
    Add(i64, Pose),
    /// An open-ended run ends after the poses that it has.
    Close,
    /// The run measures the pose of this label again, next.
    Repeat(i64),
    /// Ends whatever is going on and stops the platform.
    Abort,
    /// The pose of this label is stored.
    Stored(i64),
    /// Drives to targets for a verification, of which some are measured.
    Verify(Vec<CheckTarget>, Stage, Vec<CheckRow>),
    /// Writes values instead of the old ones, unless the controller holds others.
    Write {
        /// Values on the controller before writing.
        old: Vec<(String, f64)>,
        new: Vec<(String, f64)>,
        purpose: Purpose,
    },
    /// Finds out which of old and new values it holds after writing was interrupted; if it is armed, the old ones are
    /// restored in a mixture.
    Settle {
        /// Values before writing.
        old: Vec<(String, f64)>,
        new: Vec<(String, f64)>,
    },
}

pub struct MeasuringRequest {
    /// Labels and poses.
    pub plan: Vec<(i64, Pose)>,
    /// Labels of the plan that are measured already.
    pub measured: Vec<i64>,
    /// What readings are compared with.
    pub model: Robot,
    /// Whether poses are added one by one, so that the run does not end when all are measured.
    pub is_open_ended: bool,
}

/// How far a new pose is from what was expected of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Surprise {
    pub label: i64,
    /// Predicted less measured length of each cable (m).
    pub lengths_m: Vec<f64>,
    /// Predicted less measured laser distance (m).
    pub laser_m: Option<f64>,
}

/// Event of the driver thread.
#[derive(Debug)]
pub enum DriverEvent {
    Connected {
        identity: String,
        protection: Option<LinkProtection>,
        parameters: Vec<ParameterInfo>,
        /// What it is made of.
        rig: Box<ConnectionSetup>,
        session_id: u64,
    },
    /// The connection has ended; why, if not by order.
    Disconnected(Option<String>),
    /// The connection is lost and is being re-established; why.
    Lost(String),
    /// A lost connection is there again, not armed; what the controller holds now.
    Regained(Vec<ParameterInfo>),
    /// What the controller holds before the first pose of a run is commanded.
    ValuesAtStart(Vec<ParameterInfo>),
    /// Controller values after the run.
    ValuesAtEnd(Vec<ParameterInfo>),
    /// The controller is going to a pose.
    Commanded(i64),
    /// A pose is measured and waits to be stored.
    Measured(Box<MeasuredPose>, Option<Surprise>),
    Warning(Warning),
    Skipped(i64),
    /// The run waits; why.
    Paused(String),
    Resumed,
    /// The run has ended: nothing is left, or why it ended early.
    RunEnded(Result<(), String>),
    /// The run has ended because the controller was restarted, so that no run can continue it.
    RunRestarted(String),
    /// A verification has ended, with its rows until then and the reason if it ended early.
    Verified(Stage, Vec<CheckRow>, Result<(), String>),
    Parameters(Vec<ParameterInfo>),
    /// An attempt to write, and what the controller holds now.
    Written {
        values: Vec<(String, f64)>,
        purpose: Purpose,
        /// Adjustment, or why nothing was written.
        result: Result<Box<Adjustment>, String>,
        /// Values read back; `None` if reading failed.
        holds: Option<Vec<ParameterInfo>>,
    },
    /// An interrupted attempt to write was looked at, and settled if possible; what the controller holds now.
    Settled {
        /// What it held.
        found: ControllerValues,
        adjustment: Box<Adjustment>,
        /// Values read back; `None` if reading failed.
        holds: Option<Vec<ParameterInfo>>,
    },
    /// Something that was asked for was not done; why.
    Refused(String),
    /// There is no connection because the certificate of the server is not trusted.
    Untrusted(Box<UntrustedServer>),
}

/// What a run does at this moment.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Doing {
    #[default]
    Nothing,
    Moving,
    /// Waiting for the platform to stand still.
    Settling {
        /// Rates of change; `None` before there are enough samples.
        rates: Option<Rates>,
        /// Largest rates at rest.
        limits: Rates,
        /// At least this much time is left (s).
        remaining_s: f64,
    },
    /// Waiting for the laser distance that the operator types.
    Asking {
        label: i64,
        /// What is expected there (m), where that can be said.
        expected_m: Option<f64>,
    },
    Sampling {
        taken: usize,
        of: usize,
    },
    Verifying {
        done: usize,
        /// Targets in all.
        of: usize,
    },
    /// Waiting for the pose that the operator reads and types at a target.
    Locating {
        /// Number of the target, from 1.
        number: usize,
        /// Targets in all.
        of: usize,
    },
}

/// A lost connection, while it is being re-established.
#[derive(Debug, Clone, PartialEq)]
pub struct Lost {
    pub why: String,
    /// When the next attempt is made.
    pub due: Instant,
}

/// What the controller and its run do at this moment.
#[derive(Debug, Clone, Default)]
pub struct Live {
    pub state: Option<ControllerState>,
    /// The lost connection that is being re-established.
    pub lost: Option<Lost>,
    pub sample: Option<Sample>,
    /// Where the platform is by these readings.
    pub pose: Option<Pose>,
    pub doing: Doing,
    /// Poses that are still to be measured.
    pub remaining: usize,
    /// Time until a verification ends (s, clock of the controller); `None` before the second target.
    pub remaining_s: Option<f64>,
}

/// Pose, trail and tensions of the platform during an operation and after a stop.
#[derive(Debug, Clone, PartialEq)]
pub struct LivePlatform {
    /// Pose of the platform, by its readings.
    pub pose: Pose,
    /// Where it has been since this began (m).
    pub trail: Arc<Vec<Vec3>>,
    /// Whether it rests there because it was stopped.
    pub is_stopped: bool,
    /// Tension of each cable (N); empty or NaN where it is not known.
    pub tensions_n: Vec<f64>,
}

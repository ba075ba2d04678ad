//! Commands, events and status between the window and the thread that owns the controller.

use std::sync::Arc;
use std::time::Instant;

use tautline_core::geometry::{Pose, Vec3};
use tautline_core::robot::Robot;
use tautline_link::adjusting::{Adjustment, ControllerValues};
use tautline_link::measuring::{Rates, Warning};
use tautline_link::verifying::CheckTarget;
use tautline_link::{ControllerState, ParameterInfo, Sample};
use tautline_session::{CheckPose, CheckRow, MeasuredPose, Stage};

use tautline_workflow::adjusting::Purpose;
use tautline_workflow::controllers::ConnectionSetup;

/// What the thread is to do.
pub enum DriverCommand {
    /// Connects, for the session of this id.
    Connect(Box<ConnectionSetup>, u64),
    /// Ends the connection; a run ends with it.
    Disconnect,
    /// Allows motion and writing.
    Arm,
    /// Forbids motion and writing.
    Disarm,
    /// Whether readings are wanted while nothing else goes on.
    Watch(bool),
    /// Speed of a simulated robot's time.
    Speed(f64),
    /// Begins a measuring run.
    Measure(Box<MeasuringRequest>),
    /// The run waits.
    Pause,
    /// The run goes on.
    Resume,
    /// The run leaves out the pose under way.
    Skip,
    /// The run measures the pose of this label again, next.
    Repeat(i64),
    /// Ends whatever is going on and stops the platform.
    Abort,
    /// The pose of this label is stored.
    Stored(i64),
    /// The laser distance (m) at the pose of this label as the operator reads it; `None`: it has no return.
    LaserDistance(i64, Option<f64>),
    /// Drives to targets for a verification.
    Verify(Vec<CheckTarget>, Stage),
    /// The pose at the target of this number of the verification, from 1, as the operator reads it.
    TypedPose(usize, CheckPose),
    /// Tries at once to reconnect.
    TryNow,
    /// Reads what the controller holds.
    ReadParameters,
    /// Writes values instead of the old ones, unless the controller holds others.
    Write {
        /// What it holds.
        old: Vec<(String, f64)>,
        /// What is to be written.
        new: Vec<(String, f64)>,
        /// Why.
        purpose: Purpose,
    },
    /// Finds out which of old and new values it holds after writing was interrupted; if it is armed, the old ones are
    /// restored in a mixture.
    Settle {
        /// What it held before.
        old: Vec<(String, f64)>,
        /// What was to be written.
        new: Vec<(String, f64)>,
    },
}

/// A measuring run.
pub struct MeasuringRequest {
    /// Labels and poses.
    pub plan: Vec<(i64, Pose)>,
    /// Labels of the plan that are measured already.
    pub measured: Vec<i64>,
    /// What readings are compared with.
    pub model: Robot,
}

/// How far a new pose is from what was expected of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Surprise {
    /// Label in the run.
    pub label: i64,
    /// Predicted less measured length of each cable (m).
    pub lengths_m: Vec<f64>,
    /// Predicted less measured laser distance (m).
    pub laser_m: Option<f64>,
}

/// What the thread has to tell.
#[derive(Debug)]
pub enum DriverEvent {
    /// There is a connection.
    Connected {
        /// Name of the controller.
        identity: String,
        /// What it holds.
        parameters: Vec<ParameterInfo>,
        /// What it is made of.
        rig: Box<ConnectionSetup>,
        /// Id of the session that it is for.
        session_id: u64,
    },
    /// The connection has ended; why, if not by order.
    Disconnected(Option<String>),
    /// The connection is lost and is being re-established; why.
    Lost(String),
    /// A lost connection is there again, not armed; what the controller holds now.
    Regained(Vec<ParameterInfo>),
    /// The controller is going to a pose.
    Commanded(i64),
    /// A pose is measured and waits to be stored.
    Measured(Box<MeasuredPose>, Option<Surprise>),
    /// Something does not look right.
    Warning(Warning),
    /// A pose was left out.
    Skipped(i64),
    /// The run waits; why.
    Paused(String),
    /// The run goes on.
    Resumed,
    /// The run has ended: nothing is left, or why it ended early.
    RunEnded(Result<(), String>),
    /// The run has ended because the controller was restarted, so that no run can continue it.
    RunRestarted(String),
    /// A verification has ended, with its rows until then and the reason if it ended early.
    Verified(Stage, Vec<CheckRow>, Result<(), String>),
    /// What the controller holds now.
    Parameters(Vec<ParameterInfo>),
    /// An attempt to write, and what the controller holds now.
    Written {
        /// What was to be written.
        values: Vec<(String, f64)>,
        /// Why.
        purpose: Purpose,
        /// What came of it, or why nothing was written.
        result: Result<Box<Adjustment>, String>,
        /// What the controller holds now, if it tells.
        holds: Option<Vec<ParameterInfo>>,
    },
    /// An interrupted attempt to write was looked at, and settled if possible; what the controller holds now.
    Settled {
        /// What it held.
        found: ControllerValues,
        /// What came of it.
        adjustment: Box<Adjustment>,
        /// What it holds now, if it tells.
        holds: Option<Vec<ParameterInfo>>,
    },
    /// Something that was asked for was not done; why.
    Refused(String),
}

/// What a run does at this moment.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Doing {
    /// No run.
    #[default]
    Nothing,
    Moving,
    /// Waiting for the platform to stand still.
    Settling {
        /// How fast readings change, where enough samples tell it.
        rates: Option<Rates>,
        /// How fast they may.
        limits: Rates,
        /// At least this much time is left (s).
        remaining_s: f64,
    },
    /// Waiting for the laser distance that the operator types.
    Asking {
        /// Label of the pose.
        label: i64,
        /// What is expected there (m), where that can be said.
        expected_m: Option<f64>,
    },
    /// Taking samples.
    Sampling {
        /// Taken so far.
        taken: usize,
        /// Wanted.
        of: usize,
    },
    Verifying {
        /// Targets commanded so far.
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
    /// State of the controller; `None` without a connection.
    pub state: Option<ControllerState>,
    /// The lost connection that is being re-established.
    pub lost: Option<Lost>,
    /// The last readings.
    pub sample: Option<Sample>,
    /// Where the platform is by these readings.
    pub pose: Option<Pose>,
    /// What the run does.
    pub doing: Doing,
    /// Poses that are still to be measured.
    pub remaining: usize,
    /// Time until a verification is over (s), by the controller's clock, once targets tell.
    pub remaining_s: Option<f64>,
}

/// Where the platform is now and what its sensors say, while it is measured and after it was stopped.
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

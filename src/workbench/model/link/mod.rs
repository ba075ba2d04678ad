//! Interface of the window to the controller: a thread owns it, commands go there, events come back.
//!
//! Between operations the thread sleeps; it wakes the window at most 20 times a second.

mod connection;
mod message;
mod operation;
mod progress;
mod publisher;
mod run;
pub mod scope;
mod trail;
mod worker;

use std::sync::mpsc::{self, Receiver, Sender};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, JoinHandle};

use tautline_core::geometry::Pose;
use tautline_core::robot::Robot;
use tautline_link::opcua::Password;
use tautline_link::verifying::CheckTarget;
use tautline_link::{Activity, ControllerState, LinkProtection, ParameterInfo};
use tautline_session::{CheckRow, Stage};

use self::publisher::StatusPublisher;
use self::scope::Scope;
use self::worker::serve;
use tautline_workflow::controllers::ConnectionSetup;
use tautline_workflow::sequential::SequentialRun;

pub use self::message::{
    DriverCommand, DriverEvent, LinkRequest, LivePlatform, LiveState, LostConnection,
    MeasuringRequest, PoseDeviation, RunStep,
};
pub use self::progress::duration;
pub use self::run::{PendingPose, RunLog};
pub use self::trail::Trail;
use tautline_workflow::adjusting::Purpose;

/// Default time factor of a simulated robot: the whole demonstration takes about five minutes.
pub const SIMULATED_SPEED: f64 = 5.0;

/// Open connection.
#[derive(Debug, Clone)]
pub struct Connected {
    /// Id of its session.
    pub session_id: u64,
    pub rig: Box<ConnectionSetup>,
}

#[derive(Debug, Clone, PartialEq)]
pub struct ValuesToWrite {
    pub old: Vec<(String, f64)>,
    /// Values after writing.
    pub new: Vec<(String, f64)>,
    pub purpose: Purpose,
}

pub struct Link {
    context: egui::Context,
    commands: Option<Sender<DriverCommand>>,
    events: Option<Receiver<DriverEvent>>,
    live: Arc<Mutex<LiveState>>,
    scope: Arc<Mutex<Option<Scope>>>,
    thread: Option<JoinHandle<()>>,
    speed: f64,
    pub connected: Option<Connected>,
    pub identity: String,
    /// Protection of the messages (signing, encryption).
    pub protection: Option<LinkProtection>,
    /// Password of the user at the controller, as typed; stored nowhere else.
    pub password: Option<Password>,
    /// Whether the password is stored once the controller has accepted it.
    pub keeps_password: bool,
    pub parameters: Vec<ParameterInfo>,
    pub parameters_version: u64,
    /// Measuring run, also after its end.
    pub run: Option<RunLog>,
    /// Measured pose that is not stored yet.
    pub pending: Option<PendingPose>,
    /// Stage of the running verification.
    pub verifying: Option<Stage>,
    /// Targets of the last verification.
    pub targets: Vec<CheckTarget>,
    /// Whether a connection is being made.
    pub connecting: bool,
    /// Whether the controller is armed once connected; simulated robots only.
    pub arms_when_connected: bool,
    pub writing: bool,
    /// Values to be written once their record is on disk.
    pub to_write: Option<ValuesToWrite>,
    /// Whether the sensors are polled between operations.
    pub polls_when_idle: bool,
    /// Trail of the current or last operation.
    pub trail: Trail,
    /// Whether the last operation was stopped; the platform may still brake.
    pub is_stopped: bool,
}

impl Link {
    /// No connection yet; `speed` is the time factor of simulated robots.
    #[must_use]
    pub fn new(context: egui::Context, speed: f64) -> Self {
        Self {
            context,
            commands: None,
            events: None,
            live: Arc::default(),
            scope: Arc::default(),
            thread: None,
            speed: if speed.is_finite() && speed > 0.0 {
                speed
            } else {
                1.0
            },
            connected: None,
            identity: String::new(),
            protection: None,
            password: None,
            keeps_password: false,
            parameters: Vec::new(),
            parameters_version: 0,
            run: None,
            pending: None,
            verifying: None,
            targets: Vec::new(),
            connecting: false,
            arms_when_connected: false,
            writing: false,
            to_write: None,
            polls_when_idle: false,
            trail: Trail::default(),
            is_stopped: false,
        }
    }

    /// Events since the last call.
    pub fn events(&self) -> Vec<DriverEvent> {
        let events = self.events.iter().flat_map(Receiver::try_iter);
        events.collect()
    }

    /// Present state of the controller.
    #[must_use]
    pub fn live(&self) -> LiveState {
        self.live
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .clone()
    }

    /// Passes the latest readings to `of`; `None` before the first connection.
    pub fn scope<T>(&self, of: impl FnOnce(&Scope) -> T) -> Option<T> {
        let scope = self.scope.lock().unwrap_or_else(PoisonError::into_inner);
        scope.as_ref().map(of)
    }

    #[must_use]
    pub fn is_connected(&self) -> bool {
        self.with_live(|live| live.state.is_some())
    }

    /// Whether the controller may move and change values.
    #[must_use]
    pub fn is_armed(&self) -> bool {
        self.with_live(|live| live.state.as_ref().is_some_and(|state| state.armed))
    }

    /// Whether there is a measuring run, paused or not.
    #[must_use]
    pub fn is_measuring(&self) -> bool {
        self.run.as_ref().is_some_and(|run| !run.has_ended())
    }

    /// Whether a measuring run is active: not paused, and its controller armed.
    #[must_use]
    pub fn is_under_way(&self) -> bool {
        let run = self.run.as_ref().filter(|run| !run.has_ended());
        run.is_some_and(|run| run.paused.is_none()) && self.is_armed()
    }

    /// Whether an operation uses the controller.
    #[must_use]
    pub fn is_busy(&self) -> bool {
        self.is_measuring() || self.verifying.is_some() || self.writing
    }

    /// Whether the platform moves or could move.
    #[must_use]
    pub fn can_move(&self) -> bool {
        let moves = |state: &ControllerState| state.activity == Activity::Moving || state.armed;
        self.with_live(|live| live.state.as_ref().is_some_and(moves)) || self.is_busy()
    }

    fn with_live<T>(&self, of: impl FnOnce(&LiveState) -> T) -> T {
        of(&self.live.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Lost connection, while it is being re-established.
    #[must_use]
    pub fn lost(&self) -> Option<LostConnection> {
        self.with_live(|live| live.lost.clone())
    }

    /// Time factor of a simulated robot; 1 for a real robot.
    #[must_use]
    pub fn speed(&self) -> f64 {
        let connected = self.connected.as_ref();
        match connected.is_some_and(|connected| connected.rig.runs_in_real_time()) {
            true => 1.0,
            false => self.speed,
        }
    }

    pub fn set_speed(&mut self, speed: f64) {
        self.speed = speed;
        self.send(DriverCommand::Speed(speed));
    }

    /// Connects to the controller `rig`, for the session of this id.
    pub fn connect(&mut self, rig: ConnectionSetup, session_id: u64) {
        self.start();
        self.connecting = true;
        self.send(DriverCommand::Connect(Box::new(rig), session_id));
        self.send(DriverCommand::PollWhenIdle(self.polls_when_idle));
    }

    /// Removes the connection after its end.
    pub fn forget(&mut self) {
        self.connected = None;
        self.parameters.clear();
        self.parameters_version += 1;
        self.begin();
        self.verifying = None;
        self.writing = false;
        self.to_write = None;
    }

    /// Stores the values of the controller.
    pub fn take_parameters(&mut self, parameters: Vec<ParameterInfo>) {
        self.parameters = parameters;
        self.parameters_version += 1;
    }

    /// Switches polling of the sensors between operations.
    pub fn poll_when_idle(&mut self, polls_when_idle: bool) {
        self.polls_when_idle = polls_when_idle;
        self.send(DriverCommand::PollWhenIdle(polls_when_idle));
    }

    /// Measures the poses of a plan that are not measured yet, then those chosen by `until`, in addition to the number
    /// measured before; readings are compared with `model`.
    pub fn measure(
        &mut self,
        plan: Vec<(i64, Pose)>,
        measured: Vec<i64>,
        model: Robot,
        until: Option<(SequentialRun, usize)>,
    ) {
        self.begin();
        let labels = plan.iter().map(|(label, _)| *label);
        let to_measure = labels.filter(|label| !measured.contains(label));
        // Warnings of an earlier run are kept.
        let before = self.run.take();
        let is_open_ended = until.is_some();
        let poses = measured.iter().filter(|label| **label != 0).count();
        let (until, poses) = match until {
            Some((until, poses)) => (Some(until), poses),
            None => (None, poses),
        };
        let mut run = RunLog::new(to_measure, poses);
        run.warnings = before.map_or_else(Vec::new, |run| run.warnings);
        run.until = until;
        self.run = Some(run);
        self.send(DriverCommand::Measure(Box::new(MeasuringRequest {
            plan,
            measured,
            model,
            is_open_ended,
        })));
    }

    /// Stops the platform and ends the operation.
    pub fn stop(&mut self) {
        self.is_stopped = self.is_connected();
        self.send(DriverCommand::Abort);
    }

    /// Prepares for an operation that moves the platform.
    fn begin(&mut self) {
        self.trail = Trail::default();
        self.is_stopped = false;
    }

    /// Measures a pose again, next.
    pub fn repeat(&mut self, label: i64) {
        if let Some(run) = &mut self.run {
            run.again(label);
        }
        self.send(DriverCommand::Repeat(label));
    }

    pub fn verify(&mut self, targets: Vec<CheckTarget>, stage: Stage, rows: Vec<CheckRow>) {
        self.begin();
        self.verifying = Some(stage);
        self.targets.clone_from(&targets);
        self.send(DriverCommand::Verify(targets, stage, rows));
    }

    /// Prepares values that are written once their record is on disk.
    pub fn prepare(&mut self, values: ValuesToWrite) {
        self.writing = true;
        self.to_write = Some(values);
    }

    pub fn write(&mut self) {
        if let Some(ValuesToWrite { old, new, purpose }) = self.to_write.take() {
            self.send(DriverCommand::Write { old, new, purpose });
        }
    }

    /// Starts the thread at the first connection.
    fn start(&mut self) {
        if self.commands.is_some() {
            return;
        }
        let (commands, receive) = mpsc::channel();
        let (events, arrived) = mpsc::channel();
        let publisher = StatusPublisher {
            events,
            live: Arc::clone(&self.live),
            scope: Arc::clone(&self.scope),
            context: self.context.clone(),
            woken: None,
        };
        let speed = self.speed;
        self.thread = thread::Builder::new()
            .name("controller".into())
            .spawn(move || serve(&receive, publisher, speed))
            .ok();
        self.commands = Some(commands);
        self.events = Some(arrived);
    }

    /// Sends a command to the thread of the controller, if it runs.
    pub fn send(&self, command: impl Into<DriverCommand>) {
        if let Some(commands) = &self.commands {
            // The thread ends only with the program.
            let _ = commands.send(command.into());
        }
    }
}

impl Drop for Link {
    fn drop(&mut self) {
        self.commands = None;
        if let Some(thread) = self.thread.take() {
            // A thread that panicked has stopped already.
            let _ = thread.join();
        }
    }
}

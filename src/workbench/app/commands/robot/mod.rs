//! Phases 3 and 5: poses to measure, the measuring run, what is written to the controller.

mod adjust;
mod files;
mod plan;
mod run;
mod setup;

use std::path::PathBuf;

use tautline_link::ParameterInfo;
use tautline_session::{CheckPose, Phase, Stage};

use crate::app::robot::{Connected, Report};
use crate::app::state::State;
use tautline_workflow::controllers::{Kind, Rig};
use tautline_workflow::wording;

pub use adjust::{differences, revertible, title};
pub use files::Export;
pub use plan::{EXPECTING, PLANNING};
pub use run::{kept, not_kept, sentence};
pub use setup::{CHECKING, Setup, SetupOutcome};
pub use tautline_workflow::planning::Outlook;

/// Concerns the robot: what to measure, its controller, what it is told.
#[derive(Debug, Clone)]
pub enum RobotCommand {
    /// Chooses so many poses to measure.
    Plan(usize),
    /// Computes what to expect of the plan that there is.
    Expect,
    /// Takes a pose from the plan.
    RemovePlanned(i64),
    /// Adds the pose that is commanded now to the plan.
    AddCurrent,
    /// Opens the window that connects, or does what it says.
    Setup(Setup),
    /// Connects to the controller of the session's settings.
    Connect,
    /// Tries at once to make a lost connection anew.
    TryNow,
    /// The laser distance (m) at the pose of this label as the operator reads it; `None`: it has no return.
    LaserDistance(i64, Option<f64>),
    /// Where the platform is at the target of this number of a verification, as the operator reads it.
    TypedPose(usize, CheckPose),
    /// Ends the connection.
    Disconnect,
    /// Allows motion and writing.
    Arm,
    /// Forbids motion and writing.
    Disarm,
    /// Shows readings while nothing goes on, or no longer.
    Watch(bool),
    /// Lets the time of a simulated robot run so many times faster than real.
    Speed(f64),
    /// Measures the planned poses that are not measured yet.
    Start,
    /// Lets the run wait.
    Pause,
    /// Lets the run go on.
    Resume,
    /// Leaves out the pose under way.
    Skip,
    /// Measures a pose again.
    Repeat(i64),
    /// Ends whatever is going on and stops the platform.
    Stop,
    /// Tries again to keep a measured pose that could not be kept.
    KeepAgain,
    /// Measures test poses and paths with the external instrument.
    Verify(Stage),
    /// Takes the imported check as a run.
    TakeCheck(Stage),
    /// Reads what the controller holds.
    ReadBack,
    /// Writes the identified values to the controller; asks first where the identification did not converge.
    Write,
    /// Answers whether values that did not converge are written.
    WriteUnconverged(bool),
    /// Writes the values that were there before the last adjustment.
    RollBack,
    /// Writes a file; asks for its place.
    AskExport(Export),
    /// Writes a file.
    Export(Export, PathBuf),
    /// Shows what the demonstration has hidden.
    Reveal,
}

/// What a task came to.
#[derive(Debug)]
pub enum RobotOutcome {
    /// Of planning, for the document of this identity.
    Planned {
        /// Identity of the document.
        document: u64,
        /// The plan and what to expect of it, or one sentence.
        result: Result<Box<Outlook>, String>,
    },
    /// Of looking at the plan of the document of this identity.
    Expected {
        /// Identity of the document.
        document: u64,
        /// What to expect of it, or one sentence.
        result: Result<Box<Outlook>, String>,
    },
    /// Of the window that connects.
    Setup(SetupOutcome),
    /// A place for a file was picked, or not.
    Picked(Export, Option<PathBuf>),
    /// A file was written.
    Exported(PathBuf, Result<(), String>),
}

pub(super) fn perform(state: &mut State, command: RobotCommand) {
    match command {
        RobotCommand::Plan(poses) => plan::start(state, poses),
        RobotCommand::Expect => plan::expect_stored(state),
        RobotCommand::RemovePlanned(label) => plan::remove(state, label),
        RobotCommand::AddCurrent => plan::add_current(state),
        RobotCommand::Setup(setup) => setup::perform(state, setup),
        RobotCommand::Connect => connect(state),
        RobotCommand::TryNow => state.link.try_now(),
        RobotCommand::LaserDistance(label, distance_m) => {
            state.link.laser_distance(label, distance_m);
        }
        RobotCommand::TypedPose(number, pose) => state.link.typed_pose(number, pose),
        RobotCommand::Disconnect => state.link.disconnect(),
        RobotCommand::Arm => state.link.arm(true),
        RobotCommand::Disarm => state.link.arm(false),
        RobotCommand::Watch(watches) => state.link.watch(watches),
        RobotCommand::Speed(speed) => state.link.set_speed(speed),
        RobotCommand::Start => run::start(state),
        RobotCommand::Pause => state.link.pause(),
        RobotCommand::Resume => state.link.resume(),
        RobotCommand::Skip => state.link.skip(),
        RobotCommand::Repeat(label) => run::repeat(state, label),
        RobotCommand::Stop => state.link.abort(),
        RobotCommand::KeepAgain => run::keep_again(state),
        RobotCommand::Verify(stage) => adjust::verify(state, stage),
        RobotCommand::TakeCheck(stage) => adjust::take_check(state, stage),
        RobotCommand::ReadBack => state.link.read_back(),
        RobotCommand::Write => adjust::write(state),
        RobotCommand::WriteUnconverged(wanted) => adjust::write_unconverged(state, wanted),
        RobotCommand::RollBack => adjust::roll_back(state),
        RobotCommand::AskExport(export) => files::ask(state, export),
        RobotCommand::Export(export, path) => files::write(state, export, path),
        RobotCommand::Reveal => adjust::reveal(state),
    }
}

pub(super) fn receive(state: &mut State, outcome: RobotOutcome) {
    match outcome {
        RobotOutcome::Planned { document, result } => plan::planned(state, document, result),
        RobotOutcome::Expected { document, result } => plan::expected(state, document, result),
        RobotOutcome::Setup(outcome) => setup::receive(state, outcome),
        RobotOutcome::Picked(export, Some(path)) => files::write(state, export, path),
        RobotOutcome::Picked(_, None) => state.messages.info("No file was chosen."),
        RobotOutcome::Exported(path, Ok(())) => {
            state.messages.info(format!("Wrote {}.", path.display()));
        }
        RobotOutcome::Exported(_, Err(error)) => state.messages.error(error),
    }
}

fn connect(state: &mut State) {
    let Some(document) = &state.document else {
        return;
    };
    if state.link.is_busy() {
        return;
    }
    let identified = document.fit().map_or(&[][..], |fit| &fit.model.effects);
    let session = document.session();
    let rig = Rig::of(session, identified);
    if let (Kind::Recording, Some(recording)) = (rig.kind, &session.connection.recording) {
        state.link.set_speed(recording.speed);
    }
    state.link.connect(rig, document.identity());
}

/// Takes what the controller's thread has to tell.
pub fn reported(state: &mut State, report: Report) {
    match report {
        Report::Connected {
            identity,
            parameters,
            rig,
            document,
        } => {
            state.link.connecting = false;
            // The window that connects has done what it was opened for.
            state.screens.connect.take_if(|draft| draft.connects);
            state.messages.info(format!("Connected: {identity}."));
            state.link.identity = identity;
            state.link.connected = Some(Connected { document, rig });
            state.link.take_parameters(parameters);
        }
        Report::Disconnected(why) => disconnected(state, why),
        Report::Lost(why) => lost(state, &why),
        Report::Regained(parameters) => regained(state, parameters),
        Report::Refused(text) => refused(state, &text),
        Report::Parameters(parameters) => {
            state.link.take_parameters(parameters);
            state.messages.info("Read what the controller holds.");
        }
        Report::Written {
            values,
            purpose,
            result,
            holds,
        } => {
            state.link.writing = false;
            if let Some(holds) = holds {
                state.link.take_parameters(holds);
            }
            adjust::written(state, &values, purpose, result);
        }
        Report::Verified(stage, result) => adjust::verified(state, stage, result),
        report => run::reported(state, report),
    }
}

/// Something was not done; the window that connects says so, too.
fn refused(state: &mut State, text: &str) {
    let text = format!("{}.", wording::sentence(text.trim_end_matches('.')));
    if state.link.connecting
        && let Some(draft) = &mut state.screens.connect
    {
        draft.refused = Some(text.clone());
        draft.connects = false;
    }
    state.link.connecting = false;
    state.messages.error(text);
}

fn lost(state: &mut State, why: &str) {
    let armed = "The robot is not armed any more; the connection is made anew by itself.";
    let why = wording::sentence(why.trim_end_matches('.'));
    let text = format!("{why}. {armed}");
    if let Some(document) = &mut state.document {
        document.log(Phase::Poses, &text);
    }
    state.messages.error(text);
}

/// The connection is there again: what the controller holds may be something else.
fn regained(state: &mut State, parameters: Vec<ParameterInfo>) {
    let before = &state.link.parameters;
    let is_other = |now: &&ParameterInfo| {
        let held = before.iter().find(|held| held.name == now.name);
        held.is_none_or(|held| held.value != now.value)
    };
    let others = parameters.iter().filter(is_other).count();
    let holds = match others {
        0 => "It holds the values that it held before.".to_owned(),
        1 => "Attention: one of its values is not what it was.".to_owned(),
        many => format!("Attention: {many} of its values are not what they were."),
    };
    state.link.take_parameters(parameters);
    let text = format!("The connection is there again. {holds} Arm the controller to go on.");
    match others {
        0 => state.messages.info(text),
        _ => state.messages.warning(text),
    }
}

fn disconnected(state: &mut State, why: Option<String>) {
    state.link.forget();
    state.views.robot_3d.live = None;
    match why {
        Some(why) => state
            .messages
            .error(format!("{}.", wording::sentence(&why))),
        None => state.messages.info("Disconnected from the controller."),
    }
}

/// What has to be so before every frame: a connection ends with its document, and the robot is drawn where it is.
pub fn follow(state: &mut State) {
    let document = state.document.as_ref().map(|document| document.identity());
    if let Some(connected) = &state.link.connected
        && Some(connected.document) != document
    {
        state.link.disconnect();
        state.link.forget();
        state.link.run = None;
        state.link.pending = None;
        state.views.robot_3d.live = None;
    }
    run::draw(state);
}

/// Whether what is connected, if anything, is the simulated robot of the session.
#[must_use]
pub fn is_true_to_session(state: &State) -> bool {
    let connected = state.link.connected.as_ref();
    connected.is_none_or(|connected| connected.rig.kind == Kind::OfSession)
}

//! Phases 3 and 5: poses to measure, the measuring run, what is written to the controller.

mod adjust;
mod files;
mod plan;
mod run;
mod setup;

use tautline_link::ParameterInfo;
use tautline_session::Phase as LogPhase;

use crate::model::command::{RobotCommand, RobotOutcome};
use crate::model::link::{Connected, DriverEvent};
use crate::shell::State;
use tautline_workflow::controllers::{ConnectionSetup, Kind};
use tautline_workflow::wording;

pub use self::adjust::{differences, revertible};
pub use self::run::{kept, not_kept, sentence};

pub(super) fn perform(state: &mut State, command: RobotCommand) {
    match command {
        RobotCommand::Plan(poses) => plan::start(state, poses),
        RobotCommand::Expect => plan::expect_stored(state),
        RobotCommand::RemovePlanned(label) => plan::remove(state, label),
        RobotCommand::AddCurrent => plan::add_current(state),
        RobotCommand::Setup(setup) => setup::perform(state, setup),
        RobotCommand::Connect => connect(state),
        RobotCommand::TryNow => state.model.link.try_now(),
        RobotCommand::LaserDistance(label, distance_m) => {
            state.model.link.laser_distance(label, distance_m);
        }
        RobotCommand::TypedPose(number, pose) => state.model.link.typed_pose(number, pose),
        RobotCommand::Disconnect => state.model.link.disconnect(),
        RobotCommand::Arm => state.model.link.arm(true),
        RobotCommand::Disarm => state.model.link.arm(false),
        RobotCommand::Watch(watches) => state.model.link.watch(watches),
        RobotCommand::Speed(speed) => state.model.link.set_speed(speed),
        RobotCommand::Start => run::start(state),
        RobotCommand::Pause => state.model.link.pause(),
        RobotCommand::Resume => state.model.link.resume(),
        RobotCommand::Skip => state.model.link.skip(),
        RobotCommand::Repeat(label) => run::repeat(state, label),
        RobotCommand::Stop => state.model.link.abort(),
        RobotCommand::KeepAgain => run::keep_again(state),
        RobotCommand::Verify(stage) => adjust::verify(state, stage),
        RobotCommand::TakeCheck(stage) => adjust::take_check(state, stage),
        RobotCommand::ReadBack => state.model.link.read_back(),
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
        RobotOutcome::Planned { session_id, result } => plan::planned(state, session_id, result),
        RobotOutcome::Expected { session_id, result } => plan::expected(state, session_id, result),
        RobotOutcome::Setup(outcome) => setup::receive(state, outcome),
        RobotOutcome::Picked(export, Some(path)) => files::write(state, export, path),
        RobotOutcome::Picked(_, None) => state.model.messages.info("No file was chosen."),
        RobotOutcome::Exported(path, Ok(())) => {
            state
                .model
                .messages
                .info(format!("Wrote {}.", path.display()));
        }
        RobotOutcome::Exported(_, Err(error)) => state.model.messages.error(error),
    }
}

fn connect(state: &mut State) {
    let Some(open) = &state.model.open else {
        return;
    };
    if state.model.link.is_busy() {
        return;
    }
    let identified = open.fit().map_or(&[][..], |fit| &fit.model.effects);
    let session = open.session();
    let rig = ConnectionSetup::of(session, identified);
    if let (Kind::Recording, Some(recording)) = (rig.kind, &session.connection.recording) {
        state.model.link.set_speed(recording.speed);
    }
    state.model.link.connect(rig, open.id());
}

/// Takes what the controller's thread has to tell.
pub fn reported(state: &mut State, report: DriverEvent) {
    match report {
        DriverEvent::Connected {
            identity,
            parameters,
            rig,
            session_id,
        } => {
            state.model.link.connecting = false;
            // The window that connects has done what it was opened for.
            state.panels.connect.take_if(|draft| draft.connects);
            state.model.messages.info(format!("Connected: {identity}."));
            state.model.link.identity = identity;
            state.model.link.connected = Some(Connected { session_id, rig });
            state.model.link.take_parameters(parameters);
        }
        DriverEvent::Disconnected(why) => disconnected(state, why),
        DriverEvent::Lost(why) => lost(state, &why),
        DriverEvent::Regained(parameters) => regained(state, parameters),
        DriverEvent::Refused(text) => refused(state, &text),
        DriverEvent::Parameters(parameters) => {
            state.model.link.take_parameters(parameters);
            state.model.messages.info("Read what the controller holds.");
        }
        DriverEvent::Written {
            values,
            purpose,
            result,
            holds,
        } => {
            state.model.link.writing = false;
            if let Some(holds) = holds {
                state.model.link.take_parameters(holds);
            }
            adjust::written(state, &values, purpose, result);
        }
        DriverEvent::Verified(stage, result) => adjust::verified(state, stage, result),
        report => run::reported(state, report),
    }
}

/// Something was not done; the window that connects says so, too.
fn refused(state: &mut State, text: &str) {
    let text = format!("{}.", wording::sentence(text.trim_end_matches('.')));
    if state.model.link.connecting
        && let Some(draft) = &mut state.panels.connect
    {
        draft.refused = Some(text.clone());
        draft.connects = false;
    }
    state.model.link.connecting = false;
    state.model.messages.error(text);
}

fn lost(state: &mut State, why: &str) {
    let armed = "The robot is not armed any more; the connection is made anew by itself.";
    let why = wording::sentence(why.trim_end_matches('.'));
    let text = format!("{why}. {armed}");
    if let Some(open) = &mut state.model.open {
        open.log(LogPhase::Poses, &text);
    }
    state.model.messages.error(text);
}

/// The connection is there again: what the controller holds may be something else.
fn regained(state: &mut State, parameters: Vec<ParameterInfo>) {
    let before = &state.model.link.parameters;
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
    state.model.link.take_parameters(parameters);
    let text = format!("The connection is there again. {holds} Arm the controller to go on.");
    match others {
        0 => state.model.messages.info(text),
        _ => state.model.messages.warning(text),
    }
}

fn disconnected(state: &mut State, why: Option<String>) {
    state.model.link.forget();
    state.views.robot_3d.live = None;
    match why {
        Some(why) => state
            .model
            .messages
            .error(format!("{}.", wording::sentence(&why))),
        None => state
            .model
            .messages
            .info("Disconnected from the controller."),
    }
}

/// What has to be so before every frame: a connection ends with its document, and the robot is drawn where it is.
pub fn follow(state: &mut State) {
    let open = state.model.open.as_ref().map(|open| open.id());
    if let Some(connected) = &state.model.link.connected
        && Some(connected.session_id) != open
    {
        state.model.link.disconnect();
        state.model.link.forget();
        state.model.link.run = None;
        state.model.link.pending = None;
        state.views.robot_3d.live = None;
    }
    run::draw(state);
}

/// Whether what is connected, if anything, is the simulated robot of the session.
#[must_use]
pub fn is_true_to_session(state: &State) -> bool {
    let connected = state.model.link.connected.as_ref();
    connected.is_none_or(|connected| connected.rig.kind == Kind::OfSession)
}

//! Phases 3 and 5: planned poses, measuring run, adjustment of the controller.

mod adjust;
mod files;
mod moving;
mod plan;
mod run;
mod until;

use tautline_link::{ParameterInfo, UntrustedServer};
use tautline_session::{NamedValue, Phase as LogPhase};

use crate::commands::setup;
use crate::model::command::RobotCommand;
use crate::model::link::{Connected, DriverCommand, DriverEvent, LinkRequest};
use crate::model::messages::{Cause, full_sentence};
use crate::model::{ConnectionRequest, Model, OpenSession, UiRequest};
use tautline_workflow::adjusting::held;
use tautline_workflow::controllers::{ConnectionSetup, RobotKind};

pub use self::adjust::recorded;
pub use self::plan::planned;
pub use self::run::{autosave_failed, autosaved};

pub(super) fn perform(model: &mut Model, command: RobotCommand) {
    match command {
        RobotCommand::Plan(poses) => plan::start(model, poses),
        RobotCommand::Expect => plan::expect_stored(model),
        RobotCommand::RemovePlanned(label) => plan::remove(model, label),
        RobotCommand::AddCurrent => plan::add_current(model),
        RobotCommand::Setup(setup) => setup::perform(model, setup),
        RobotCommand::Connect => connect(model, false),
        RobotCommand::ConnectAndArm => connect(model, true),
        RobotCommand::Link(request) => model.link.send(request),
        RobotCommand::Arm => {
            model.link.send(DriverCommand::Arm);
            adjust::settle(model);
        }
        RobotCommand::PollWhenIdle(polls_when_idle) => {
            model.link.poll_when_idle(polls_when_idle);
            if polls_when_idle {
                model.request(UiRequest::ShowScope);
            }
        }
        RobotCommand::Speed(speed) => model.link.set_speed(speed),
        RobotCommand::Start => run::start(model),
        RobotCommand::Repeat(label) => run::repeat(model, label),
        RobotCommand::Stop => {
            model.link.stop();
            model.playback.follows = true;
        }
        RobotCommand::RetrySave => run::retry_save(model),
        RobotCommand::Verify(stage) => adjust::verify(model, stage),
        RobotCommand::TakeCheck(stage) => adjust::take_check(model, stage),
        RobotCommand::Write => adjust::write(model),
        RobotCommand::WriteValues(values, purpose) => adjust::give(model, values, purpose),
        RobotCommand::ConfirmWrite(is_confirmed) => adjust::confirm_write(model, is_confirmed),
        RobotCommand::Accept => adjust::accept(model),
        RobotCommand::RollBack => adjust::roll_back(model),
        RobotCommand::AskExport(export) => files::ask(model, export),
        RobotCommand::Export(export, path) => files::write(model, export, path),
        RobotCommand::AskFirmware => files::ask_firmware(model),
        RobotCommand::Firmware(path) => files::correct(model, &path),
        RobotCommand::Reveal => adjust::reveal(model),
    }
}

/// Connects to the controller of the session; `arms` also arms a simulated one.
fn connect(model: &mut Model, arms: bool) {
    let Some(open) = &model.open else {
        return;
    };
    if model.link.is_busy() {
        return;
    }
    let identified = open.fit().map_or(&[][..], |fit| &fit.model.effects);
    let session = open.session();
    let rig = ConnectionSetup::of(session, identified).with_credentials(setup::credentials(model));
    if let (RobotKind::Recording, Some(recording)) = (rig.kind, &session.connection.recording) {
        model.link.set_speed(recording.speed);
    }
    model.link.connect(rig, open.id());
    model.link.arms_when_connected = arms;
    model.messages.resolve(Cause::Connection);
}

/// Handles an event of the controller's thread.
pub fn receive(model: &mut Model, event: DriverEvent) {
    match event {
        DriverEvent::Connected {
            identity,
            protection,
            parameters,
            rig,
            session_id,
        } => {
            model.link.connecting = false;
            model.messages.resolve(Cause::Connection);
            // Closes the connection dialog.
            model.request(UiRequest::Connection(ConnectionRequest::Connected));
            model.messages.info(format!("Connected: {identity}."));
            model.link.identity = identity;
            model.link.protection = protection;
            setup::accepted(model, rig.account());
            let is_own = rig.kind == RobotKind::OfSession;
            let arms = std::mem::take(&mut model.link.arms_when_connected) && is_own;
            model.link.connected = Some(Connected { session_id, rig });
            run::compare(model, &parameters);
            model.link.take_parameters(parameters);
            if arms {
                model.link.send(DriverCommand::Arm);
            }
            adjust::settle(model);
        }
        DriverEvent::Disconnected(why) => disconnected(model, why),
        DriverEvent::Lost(why) => lost(model, &why),
        DriverEvent::Regained(parameters) => regained(model, parameters),
        DriverEvent::Refused(text) => refused(model, &text),
        DriverEvent::Untrusted(server) => untrusted(model, server),
        DriverEvent::Parameters(parameters) => {
            model.link.take_parameters(parameters);
            model.messages.info("Read the values of the controller.");
        }
        DriverEvent::Written {
            values,
            purpose,
            result,
            holds,
        } => {
            model.link.writing = false;
            let read_back = take_read_back(model, holds);
            adjust::written(model, &values, purpose, result, read_back.as_deref());
        }
        DriverEvent::Settled {
            found,
            adjustment,
            holds,
        } => {
            let read_back = take_read_back(model, holds);
            adjust::settled(model, &found, &adjustment, read_back.as_deref());
        }
        DriverEvent::Verified(stage, rows, result) => adjust::verified(model, stage, rows, result),
        event => run::receive(model, event),
    }
}

/// Stores the values read back after writing, if any; they confirm the adjustment.
fn take_read_back(model: &mut Model, holds: Option<Vec<ParameterInfo>>) -> Option<Vec<NamedValue>> {
    let holds = holds?;
    let read_back = held(&holds);
    model.link.take_parameters(holds);
    Some(read_back)
}

/// Reports a failure, also in the connection dialog.
fn refused(model: &mut Model, text: &str) {
    let text = full_sentence(text);
    if std::mem::take(&mut model.link.connecting) {
        let refuse = ConnectionRequest::Refuse(text.clone());
        model.request(UiRequest::Connection(refuse));
    }
    model.messages.failure(Cause::Connection, text);
}

/// Asks in the connection dialog whether the server is trusted.
fn untrusted(model: &mut Model, server: Box<UntrustedServer>) {
    let text = full_sentence(&server.to_string());
    if std::mem::take(&mut model.link.connecting) {
        model.request(UiRequest::Connection(ConnectionRequest::AskTrust(server)));
    }
    model.messages.failure(Cause::Connection, text);
}

fn lost(model: &mut Model, why: &str) {
    let armed = "The robot is disarmed; Tautline reconnects by itself.";
    let text = format!("{} {armed}", full_sentence(why));
    if let Some(open) = &mut model.open {
        open.log(LogPhase::Poses, &text);
    }
    model.messages.failure(Cause::Connection, text);
}

/// Compares the values of the controller after a reconnection.
fn regained(model: &mut Model, parameters: Vec<ParameterInfo>) {
    let before = &model.link.parameters;
    let is_other = |now: &&ParameterInfo| {
        let held = before.iter().find(|held| held.name == now.name);
        held.is_none_or(|held| held.value != now.value)
    };
    let others = parameters.iter().filter(is_other).count();
    let holds = match others {
        0 => "Its values are unchanged.".to_owned(),
        1 => "Attention: one of its values has changed.".to_owned(),
        many => format!("Attention: {many} of its values have changed."),
    };
    match model.link.is_measuring() {
        true => run::values_at_start(model, &parameters),
        false => run::compare(model, &parameters),
    }
    model.link.take_parameters(parameters);
    model.messages.resolve(Cause::Connection);
    let text = format!("Reconnected. {holds} Arm the controller to go on.");
    match others {
        0 => model.messages.info(text),
        _ => model.messages.warning(text),
    }
    adjust::settle(model);
}

fn disconnected(model: &mut Model, why: Option<String>) {
    model.link.forget();
    model.live_platform = None;
    model.messages.resolve(Cause::Connection);
    match why {
        Some(why) => model
            .messages
            .failure(Cause::Connection, full_sentence(&why)),
        None => model.messages.info("Disconnected from the controller."),
    }
}

/// Updates before every frame: ends the connection of another session, checks the prediction of the plan, sends the run
/// to the chosen pose, and moves the robot in the views.
pub fn follow(model: &mut Model) {
    let session_id = model.open.as_ref().map(OpenSession::id);
    let connected = model.link.connected.as_ref();
    if connected.is_some_and(|connected| Some(connected.session_id) != session_id) {
        model.link.send(LinkRequest::Disconnect);
        model.link.forget();
        model.link.run = None;
        model.link.pending = None;
        model.live_platform = None;
    }
    model.check_outlook();
    until::follow_decision(model);
    run::follow_platform(model);
}

//! What every command that moves the robot does first.

use tautline_core::robot::Robot;
use tautline_workflow::controllers::RobotKind;

use crate::model::messages::Cause;
use crate::model::{Model, OpenSession, UiRequest};

/// What readings are compared with: the identified model where it is up to date, else the description.
pub(super) fn reference(open: &OpenSession) -> Robot {
    match open.fit().filter(|_| open.fit_is_current()) {
        Some(fit) => fit.model.clone(),
        None => open.session().robot.clone(),
    }
}

/// Shows the robot and its readings, and keeps in the session that they are simulated, if they are.
pub(super) fn watch(model: &mut Model) {
    let connected = model.link.connected.as_ref();
    let is_simulated = connected.is_some_and(|one| one.rig.kind == RobotKind::OfDescription);
    if let Some(open) = model.open.as_mut().filter(|_| is_simulated) {
        open.record(|session| session.has_simulated_readings = true);
    }
    model.playback.follows = true;
    model.request(UiRequest::ShowScope);
}

/// Whether nothing may move or be written because an adjustment is still to be settled; the operator is told so.
pub(super) fn refuses(model: &mut Model) -> bool {
    let unsettled = model.unsettled();
    if let Some(text) = &unsettled {
        model.messages.failure(Cause::Adjustment, text);
    }
    unsettled.is_some()
}

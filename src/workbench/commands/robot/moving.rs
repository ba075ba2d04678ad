//! Common steps of all commands that move the robot.

use tautline_core::robot::Robot;
use tautline_workflow::controllers::RobotKind;

use crate::model::messages::Cause;
use crate::model::{Model, OpenSession, UiRequest};

/// Model that predicts the readings: the identified one if it is current, otherwise the description.
pub(super) fn reference(open: &OpenSession) -> Robot {
    match open.current_fit() {
        Some(fit) => fit.model.clone(),
        None => open.session().robot.clone(),
    }
}

/// Shows the robot and its readings; records in the session if they are simulated.
pub(super) fn watch(model: &mut Model) {
    let is_simulated = model.robot_kind() == Some(RobotKind::OfDescription);
    if let Some(open) = model.open.as_mut().filter(|_| is_simulated) {
        open.record(|session| session.has_simulated_readings = true);
    }
    model.playback.follows = true;
    model.request(UiRequest::ShowScope);
}

/// Whether motion and writing are locked by an interrupted adjustment; reports it to the operator.
pub(super) fn refuses(model: &mut Model) -> bool {
    let unsettled = model.unsettled();
    if let Some(text) = &unsettled {
        model.messages.failure(Cause::Adjustment, text);
    }
    unsettled.is_some()
}

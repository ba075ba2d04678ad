//! Records of a session about the values in its controller.

use tautline_link::ParameterInfo;
use tautline_link::adjusting::Difference;
use tautline_session::{Acceptance, Adjustment, Outcome, Session, Stage, Verification};

use super::in_effect;

/// The parameters of the controller with the values that the session recorded.
pub(super) fn recorded(session: &Session) -> Vec<ParameterInfo> {
    let values = session.controller_values().into_iter();
    values
        .map(|(name, value)| ParameterInfo {
            name,
            // Differences have the units of the identified parameters.
            unit: "",
            value,
        })
        .collect()
}

/// The last adjustment that wrote identified values, its verification, and the acceptance of the robot.
#[derive(Debug, Clone, Copy)]
pub struct Written<'a> {
    /// The adjustment.
    pub adjustment: &'a Adjustment,
    /// The last run with an external instrument after it.
    pub verification: Option<&'a Verification>,
    /// The acceptance of the robot on the result of this run.
    pub acceptance: Option<&'a Acceptance>,
}

/// The record of the identified values in the controller; `None` if it holds others: nothing was written, it was rolled
/// back, or identified values differ from those written.
#[must_use]
pub fn written<'a>(session: &'a Session, differences: &[Difference]) -> Option<Written<'a>> {
    let is_other = |line: &Difference| line.is_writable_change() || line.is_unknown_effect();
    let is_different = differences.iter().any(is_other);
    let adjustment = in_effect(session)
        .filter(|last| last.outcome == Outcome::Written && !last.restores && !is_different)?;
    let mut runs = session.verifications().iter().rev();
    let verification = runs.find(|run| run.stage == Stage::After && run.time >= adjustment.time);
    Some(Written {
        adjustment,
        verification,
        acceptance: verification.and_then(|run| session.acceptance(run)),
    })
}

/// Whether values were written again after the last verification that followed an adjustment.
#[must_use]
pub fn verified_before_last_write(session: &Session) -> bool {
    let mut runs = session.verifications().iter();
    let last = runs.rfind(|run| run.stage == Stage::After);
    last.zip(in_effect(session))
        .is_some_and(|(run, written)| run.time < written.time)
}

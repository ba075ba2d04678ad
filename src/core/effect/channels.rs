//! Measurements rearranged to the channels that a model states.

use std::borrow::Cow;

use super::{BoundEffect, EffectError, Search};
use crate::measurement::Measurements;
use crate::robot::Robot;

/// Returns the measurements with every channel exchange undone that the effects of `robot` state; borrows them
/// unchanged if there is none.
///
/// # Errors
/// If an effect of the robot cannot be attached to it.
pub fn measurements_as_modelled<'a>(
    robot: &Robot,
    measurements: &'a Measurements,
) -> Result<Cow<'a, Measurements>, EffectError> {
    let mut modelled = Cow::Borrowed(measurements);
    // The last exchange is undone first: two that share a cable do not commute.
    for setting in robot.effects.iter().rev() {
        let bound = BoundEffect::from_setting(setting, robot)?;
        if bound.effect.search() == Search::Exchange {
            bound.exchange_channels(modelled.to_mut());
        }
    }
    Ok(modelled)
}

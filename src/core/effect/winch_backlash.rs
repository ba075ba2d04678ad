//! Play between motor and drum: `paid += dir play / 2`, with `dir` = +1 where the cable was paid out on the
//! way to the pose and -1 where it was reeled in; metres.
//!
//! The direction is the sign of the change of the reading since the row before, 0 at the first row. So
//! it is wrong where a cable moved by less than the play; a simulation knows the true direction.
//! Without a reversal of tension the platform lags behind the motor; with one it leads, and the play is negative. Typical 0.2 to
//! 2 mm. Source: dead band of half the play to either side, as in any drive with play.

use super::words;
use super::{AsText, Effect, EffectParameter, Scope};
use crate::measurement::Variable;

pub(super) static EFFECT: Effect = Effect {
    id: "winch_backlash",
    title: "Winch backlash",
    scope: Scope::CableOrAll,
    parameters: &[EffectParameter::new("play", "m", 0.002, [0.0002, 0.002])
        .within(0.0, f64::INFINITY)
        .with_tolerance(
            [3e-05, 6e-05],
            "Planetary gearboxes of 3 to 5 arc minutes on drums of 50 to 200 mm",
        )
        .of_either_sign_if_broken()],
    cause: |found| {
        found.say("{winch} {has|have} {0:mm} of play: at the same reading {its cable is|their cables are} {0:longer|shorter} after paying out than after reeling in.")
    },
    workshop: |found| {
        found.say("Check the coupling, the set screws and the gearbox of {winch} for play. Until it is mended, always approach poses from the same side.")
    },
    check: Some(words::GO_FROM_EITHER_SIDE),
    source: "Dead band of half the play to either side, as in any drive with play",
    change_cable: |parameters, at, ports| ports.paid += parameters[0] * (0.5 * at.direction),
    variable: Some(Variable::Direction),
    is_damage: true,
    as_text: AsText::Formulas(&[("paid", "paid + play * direction / 2")]),
    ..Effect::NEUTRAL
};

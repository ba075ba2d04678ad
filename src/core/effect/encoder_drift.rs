//! A length reading that drifts: `paid += rate t / 3600`, with the time `t` since home in seconds and the
//! rate in metres per hour. Assumes a constant rate. Typical 1 to 10 mm/h: slip that adds up, or a
//! reference that wanders.

use super::words;
use super::{AsText, Effect, EffectParameter, Scope};
use crate::measurement::Variable;

pub(super) static EFFECT: Effect = Effect {
    id: "encoder_drift",
    title: "Encoder drift",
    scope: Scope::Cable,
    parameters: &[EffectParameter::new("rate", "m/h", 0.01, [0.001, 0.01])],
    cause: |found| {
        found.say("The length {reading|readings} of {cable} {drifts|drift}: the {cable gets|cables get} {0:longer|shorter} than the {reading says|readings say} by {0:mm}/h.")
    },
    workshop: |found| {
        found.say("Check coupling and set screws between motor, encoder and drum of {winch}. Mark the {cable|cables} on the drum to see whether it slips.")
    },
    check: Some(words::GO_BACK),
    source: "Constant rate, first order in time",
    change_cable: |parameters, at, ports| ports.paid += parameters[0] * (at.time_s / 3600.0),
    variable: Some(Variable::Time),
    is_damage: true,
    as_text: AsText::Formulas(&[("paid", "paid + rate * time")]),
    ..Effect::NEUTRAL
};

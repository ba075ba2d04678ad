//! Thermal strain: `strain += alpha dT` with the change of temperature since home `dT` (K). Assumes that all of
//! the cable has the temperature measured. Typical -1e-5 (aramid, polyethylene: shorter when warm) to 5e-5 per
//! kelvin; steel 12e-6.

use super::words;
use super::{AsText, Effect, EffectParameter, Scope};
use crate::measurement::Variable;

pub(super) static EFFECT: Effect = Effect {
    id: "cable_thermal",
    title: "Thermal expansion of the cables",
    scope: Scope::CableOrAll,
    parameters: &[EffectParameter::new(
        "alpha",
        "1/K",
        0.00005,
        [-0.00001, 0.00005],
    )],
    cause: |found| {
        found.say(
            "{cable} {gets|get} {0:mm} {0:longer|shorter} per metre and per kelvin of warming.",
        )
    },
    workshop: |found| {
        found.say("Measure at a steady temperature, or correct the cable lengths for temperature in the controller.")
    },
    check: Some(words::REPEAT_WARMER),
    source: "Linear thermal expansion; steel 12e-6 per kelvin, aramid and polyethylene shorten when warm",
    change_cable: |parameters, at, ports| ports.strain += parameters[0] * at.temperature_change_k,
    variable: Some(Variable::Temperature),
    as_text: AsText::Formulas(&[("strain", "strain + alpha * temperature")]),
    ..Effect::NEUTRAL
};

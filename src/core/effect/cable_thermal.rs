//! Thermal strain: `strain += alpha dT` with the change of temperature since home `dT` (K). Assumes that all of
//! the cable has the temperature measured. Typical -1e-5 (aramid, polyethylene: shorter when warm) to 5e-5 per
//! kelvin; steel 12e-6.

use super::words::{self, sentence};
use super::{CableContext, CablePorts, Dual, Effect, EffectParameter, FoundEffect, Part, Scope};

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
    cause,
    workshop,
    check: Some(words::REPEAT_WARMER),
    source: "Linear thermal expansion; steel 12e-6 per kelvin, aramid and polyethylene shorten when warm",
    change_cable,
    ..Effect::NEUTRAL
};

fn cause(found: &FoundEffect<'_>) -> String {
    sentence(&format!(
        "{} {} {} {} per metre and per kelvin of warming.",
        found.name(Part::Cable),
        found.either("gets", "get"),
        found.millimetres(0),
        found.way(0, "longer", "shorter"),
    ))
}

fn workshop(_found: &FoundEffect<'_>) -> String {
    "Measure at a steady temperature, or correct the cable lengths for temperature in the controller.".to_owned()
}

fn change_cable(parameters: &[Dual], at: &CableContext, ports: &mut CablePorts) {
    ports.strain += parameters[0] * at.temperature_change_k;
}

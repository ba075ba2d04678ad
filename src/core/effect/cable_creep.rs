//! Strain that grows with the logarithm of time: `strain += c ln(1 + t / 600 s)`, `t` since home. Assumes that
//! the load is about constant. Typical 1e-4 to 1e-2: logarithmic creep of fibre ropes.

use super::words::{self, millimetres, sentence};
use super::{CableContext, CablePorts, Dual, Effect, EffectParameter, FoundEffect, Part, Scope};

pub(super) static EFFECT: Effect = Effect {
    id: "cable_creep",
    title: "Cable creep",
    scope: Scope::CableOrAll,
    parameters: &[EffectParameter::new("c", "1", 0.01, [0.0001, 0.01])],
    cause,
    workshop,
    check: Some(words::GO_BACK),
    source: "Logarithmic creep of fibre ropes",
    change_cable,
    ..Effect::NEUTRAL
};

fn cause(found: &FoundEffect<'_>) -> String {
    // The logarithm of 1 + 3600 s / 600 s.
    let first_hour = found.value(0) * 7_f64.ln();
    sentence(&format!(
        "{} {} under load: in the first hour each metre gets {} {}.",
        found.name(Part::Cable),
        found.either(
            found.way(0, "creeps", "shrinks"),
            found.way(0, "creep", "shrink"),
        ),
        millimetres(first_hour),
        found.way(0, "longer", "shorter"),
    ))
}

fn workshop(found: &FoundEffect<'_>) -> String {
    format!(
        "Leave {} under working tension for some hours before measuring{}.",
        found.name(Part::Cable),
        if found.counts_revolutions() {
            ", and zero the encoders at home afterwards"
        } else {
            ""
        },
    )
}

fn change_cable(parameters: &[Dual], at: &CableContext, ports: &mut CablePorts) {
    ports.strain += parameters[0] * (at.time_s.max(0.0) / 600.0).ln_1p();
}

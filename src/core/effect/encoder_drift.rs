//! A length reading that drifts: `paid += rate t / 3600`, with the time `t` since home in seconds and the
//! rate in metres per hour. Assumes a constant rate. Typical 1 to 10 mm/h: slip that adds up, or a
//! reference that wanders.

use super::words::{self, size};
use super::{CableContext, CablePorts, Dual, Effect, EffectParameter, FoundEffect, Part, Scope};

pub(super) static EFFECT: Effect = Effect {
    id: "encoder_drift",
    title: "Encoder drift",
    scope: Scope::Cable,
    parameters: &[EffectParameter::new("rate", "m/h", 0.01, [0.001, 0.01])],
    cause,
    workshop,
    check: Some(words::GO_BACK),
    source: "Constant rate, first order in time",
    change_cable,
    ..Effect::NEUTRAL
};

fn cause(found: &FoundEffect<'_>) -> String {
    format!(
        "The length {} of {} {}: the {} {} than the {}, by {} mm/h.",
        found.either("reading", "readings"),
        found.name(Part::Cable),
        found.either("drifts", "drift"),
        found.either("cable gets", "cables get"),
        found.way(0, "longer", "shorter"),
        found.either("reading says", "readings say"),
        size(1e3 * found.value(0)),
    )
}

fn workshop(found: &FoundEffect<'_>) -> String {
    format!(
        "Check coupling and set screws between motor, encoder and drum of {}. Mark the {} on the drum to see whether it slips.",
        found.name(Part::Winch),
        found.either("cable", "cables"),
    )
}

fn change_cable(parameters: &[Dual], at: &CableContext, ports: &mut CablePorts) {
    ports.paid += parameters[0] * (at.time_s / 3600.0);
}

//! Drum out of round: `A sin(2 pi rev / gear_ratio + phase) - A sin(phase)` is added to the cable paid
//! out. Typical amplitude 0.1 to 1 mm.

use super::{
    CableContext, CablePorts, Dual, Effect, EffectParameter, FoundEffect, Part, Scope, Search,
};

pub(super) static EFFECT: Effect = Effect {
    id: "drum_eccentricity",
    title: "Drum out of round",
    scope: Scope::Cable,
    parameters: &[
        EffectParameter::new("amplitude", "m", 0.001, [0.0001, 0.001]),
        EffectParameter::new(
            "phase",
            "rad",
            3.0,
            [-std::f64::consts::PI, std::f64::consts::PI],
        ),
    ],
    cause,
    workshop,
    check: Some("Turn the drum once under a dial gauge."),
    source: "Geometry of an eccentric drum; sizes from ovalisation reported for winches of cable robots",
    search: Search::Wave {
        phase: 1,
        period: None,
    },
    change_cable,
    ..Effect::NEUTRAL
};

fn cause(found: &FoundEffect<'_>) -> String {
    format!(
        "The {} of {} {} out of round: once per turn the cable paid out swings by {} to either side.",
        found.either("drum", "drums"),
        found.name(Part::Winch),
        found.either("is", "are"),
        found.millimetres(0),
    )
}

fn workshop(found: &FoundEffect<'_>) -> String {
    format!(
        "Measure the runout of the {} of {} with a dial gauge; centre or replace what runs out.",
        found.either("drum", "drums"),
        found.name(Part::Winch),
    )
}

fn change_cable(parameters: &[Dual], at: &CableContext, ports: &mut CablePorts) {
    let [amplitude, phase] = [parameters[0], parameters[1]];
    let angle = std::f64::consts::TAU * at.revolutions * at.drum_per_motor;
    ports.paid += amplitude * ((phase + angle).sin() - phase.sin());
}

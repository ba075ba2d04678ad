//! Axial stiffness other than stated: `EA (1 + change)`. Typical 10 to 50 %.

use super::words::sentence;
use super::{CableContext, CablePorts, Dual, Effect, EffectParameter, FoundEffect, Part, Scope};

pub(super) static EFFECT: Effect = Effect {
    id: "cable_stiffness",
    title: "Cable stiffness",
    scope: Scope::CableOrAll,
    parameters: &[EffectParameter::new("change", "1", 0.5, [0.1, 0.5])],
    cause,
    workshop,
    check: Some(
        "Pull a piece of the cable with a known force and measure by how much it gets longer.",
    ),
    source: "Hooke's law; sizes from stiffnesses reported for ropes",
    change_cable,
    ..Effect::NEUTRAL
};

fn cause(found: &FoundEffect<'_>) -> String {
    sentence(&format!(
        "{} {} {} {} than stated.",
        found.name(Part::Cable),
        found.either("is", "are"),
        found.percent(0),
        found.way(0, "stiffer", "less stiff"),
    ))
}

fn workshop(_found: &FoundEffect<'_>) -> String {
    "Stretch a piece of the same cable with known weights, measure by how much, and enter that stiffness.".to_owned()
}

fn change_cable(parameters: &[Dual], _at: &CableContext, ports: &mut CablePorts) {
    ports.compliance *= (parameters[0] + 1.0).recip();
}

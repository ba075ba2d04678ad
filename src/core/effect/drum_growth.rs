//! Layers build up on the drum: `paid = k rev (1 + growth rev)` with revolutions of the motor. Typical
//! 0.01 to 1 % per revolution.

use super::{
    CableContext, CablePorts, Dual, Effect, EffectParameter, FoundEffect, Part, Scope, Stage,
};

pub(super) static EFFECT: Effect = Effect {
    id: "drum_growth",
    title: "Build-up of layers on the drum",
    scope: Scope::CableOrAll,
    parameters: &[EffectParameter::new(
        "growth",
        "1/rev",
        0.01,
        [0.00005, 0.01],
    )],
    cause,
    workshop,
    check: Some("Measure the drum with calipers where it is bare and where it is full of cable."),
    source: "Geometry of a winding whose diameter changes in proportion to the turns, first order",
    stage: Stage::Ratio,
    change_cable,
    ..Effect::NEUTRAL
};

fn cause(found: &FoundEffect<'_>) -> String {
    format!(
        "The {} of {} {} no constant diameter: the cable per revolution, on average since home, {} by {} with every motor revolution.",
        found.either("drum", "drums"),
        found.name(Part::Winch),
        found.either("has", "have"),
        found.way(0, "rises", "falls"),
        found.percent(0),
    )
}

fn workshop(found: &FoundEffect<'_>) -> String {
    format!(
        "Check that the cable lies in one layer and in regular turns on the {} of {}, and guide it if it climbs over itself.",
        found.either("drum", "drums"),
        found.name(Part::Winch),
    )
}

fn change_cable(parameters: &[Dual], at: &CableContext, ports: &mut CablePorts) {
    ports.paid *= parameters[0] * at.revolutions + 1.0;
}

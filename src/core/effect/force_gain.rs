//! Force sensor of another gain: `F = g (1 + change) T + f0`, so `T = T_nominal / (1 + change)`. Typical 2 to 20 %.

use super::words::sentence;
use super::{
    CableContext, CablePorts, Dual, Effect, EffectParameter, FoundEffect, Part, Scope, Stage,
};

pub(super) static EFFECT: Effect = Effect {
    id: "force_gain",
    title: "Gain of the force sensors",
    scope: Scope::CableOrAll,
    parameters: &[EffectParameter::new("change", "1", 0.2, [0.02, 0.2])],
    cause,
    workshop,
    check: Some("Hang a known weight at the cable and read its force sensor."),
    source: "Linear sensor: Jin et al., Sensors 18 (2018) 2392, section 3.2",
    stage: Stage::Ratio,
    change_cable,
    ..Effect::NEUTRAL
};

fn cause(found: &FoundEffect<'_>) -> String {
    sentence(&format!(
        "{} {} {} too {}.",
        found.name(Part::ForceSensor),
        found.either("reads", "read"),
        found.percent(0),
        found.way(0, "high", "low"),
    ))
}

fn workshop(found: &FoundEffect<'_>) -> String {
    format!(
        "Hang known weights on {} and calibrate the gain of {} again.",
        found.name(Part::Cable),
        found.name(Part::ForceSensor),
    )
}

fn change_cable(parameters: &[Dual], _at: &CableContext, ports: &mut CablePorts) {
    ports.tension *= (parameters[0] + 1.0).recip();
}

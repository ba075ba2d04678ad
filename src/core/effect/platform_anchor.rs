//! Attachment point of a cable elsewhere on the platform: `b += (x, y, z)`, platform frame, metres. Typical 1 to
//! 10 mm.

use super::words::displacement;
use super::{CableContext, CablePorts, Dual, Effect, EffectParameter, FoundEffect, Part, Scope};

pub(super) static EFFECT: Effect = Effect {
    id: "platform_anchor",
    title: "Attachment point on the platform",
    scope: Scope::Cable,
    parameters: &[
        EffectParameter::new("x", "m", 0.01, [0.001, 0.01]),
        EffectParameter::new("y", "m", 0.01, [0.001, 0.01]),
        EffectParameter::new("z", "m", 0.01, [0.001, 0.01]),
    ],
    cause,
    workshop,
    check: Some("Measure with calipers where the cable is attached to the platform."),
    source: "Geometry",
    change_cable,
    ..Effect::NEUTRAL
};

fn cause(found: &FoundEffect<'_>) -> String {
    let offset_m = [0, 1, 2].map(|k| found.value(k));
    format!(
        "The attachment {} of {} on the platform {} off by {} (platform axes).",
        found.either("point", "points"),
        found.name(Part::Cable),
        found.either("is", "are"),
        displacement(&offset_m),
    )
}

fn workshop(found: &FoundEffect<'_>) -> String {
    format!(
        "Measure on the platform where {} {} attached, and enter that point.",
        found.name(Part::Cable),
        found.either("is", "are"),
    )
}

fn change_cable(parameters: &[Dual], _at: &CableContext, ports: &mut CablePorts) {
    for k in 0..3 {
        ports.anchor[k] += parameters[k];
    }
}

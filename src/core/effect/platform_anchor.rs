//! Displaced attachment point of a cable on the platform: `b += (x, y, z)`, platform frame, metres. Typical 1 to
//! 10 mm.

use super::{CableContext, CablePorts, Dual, Effect, EffectParameter, Scope};

pub(super) static EFFECT: Effect = Effect {
    id: "platform_anchor",
    title: "Attachment point on the platform",
    scope: Scope::Cable,
    parameters: &[
        EffectParameter::new("x", "m", 0.01, [0.001, 0.01]),
        EffectParameter::new("y", "m", 0.01, [0.001, 0.01]),
        EffectParameter::new("z", "m", 0.01, [0.001, 0.01]),
    ],
    cause: |found| {
        found.say("The attachment {point|points} of {cable} on the platform {is|are} off by {displacement} (platform axes).")
    },
    workshop: |found| {
        found.say("Measure on the platform where {cable} {is|are} attached, and enter that point.")
    },
    check: Some("Measure with calipers where the cable is attached to the platform."),
    source: "Geometry",
    change_cable,
    ..Effect::NEUTRAL
};

fn change_cable(parameters: &[Dual], _at: &CableContext, ports: &mut CablePorts) {
    for k in 0..3 {
        ports.anchor[k] += parameters[k];
    }
}

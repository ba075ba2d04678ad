//! Displaced attachment point of a cable on the platform: `b += (x, y, z)`, platform frame, metres. Typical 1 to
//! 10 mm.

use super::{AsText, CableContext, CablePorts, Dual, Effect, EffectParameter, Scope};

/// Standard deviations of sound parts, for small and large machines.
const TOLERANCE: [f64; 2] = [0.0001, 0.0003];
const SOURCE_OF_TOLERANCE: &str = "Lengths by ISO 2768-1: fine for a machined platform, medium for a \
    large one";

pub(super) static EFFECT: Effect = Effect {
    id: "platform_anchor",
    title: "Attachment point on the platform",
    scope: Scope::Cable,
    parameters: &[
        EffectParameter::new("x", "m", 0.01, [0.001, 0.01])
            .with_tolerance(TOLERANCE, SOURCE_OF_TOLERANCE),
        EffectParameter::new("y", "m", 0.01, [0.001, 0.01])
            .with_tolerance(TOLERANCE, SOURCE_OF_TOLERANCE),
        EffectParameter::new("z", "m", 0.01, [0.001, 0.01])
            .with_tolerance(TOLERANCE, SOURCE_OF_TOLERANCE),
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
    as_text: AsText::Formulas(&[
        ("anchor_x", "anchor_x + x"),
        ("anchor_y", "anchor_y + y"),
        ("anchor_z", "anchor_z + z"),
    ]),
    ..Effect::NEUTRAL
};

fn change_cable(parameters: &[Dual], _at: &CableContext, ports: &mut CablePorts) {
    for k in 0..3 {
        ports.anchor[k] += parameters[k];
    }
}

//! An entry point that jumps, as after a knock: `a += (x, y, z)`, base frame, metres, at the pose labelled `pose`
//! and at all later labels. Typical 1 to 20 mm.

use super::words::{self, displacement};
use super::{
    CableContext, CablePorts, Dual, Effect, EffectParameter, FoundEffect, Part, Scope, Search,
};

pub(super) static EFFECT: Effect = Effect {
    id: "frame_shift",
    title: "Shift of a pulley during the measurement",
    scope: Scope::Cable,
    parameters: &[
        EffectParameter::new("x", "m", 0.02, [0.001, 0.02]),
        EffectParameter::new("y", "m", 0.02, [0.001, 0.02]),
        EffectParameter::new("z", "m", 0.02, [0.001, 0.02]),
        EffectParameter::given("pose", "1", [1.0, 100.0]),
    ],
    cause,
    workshop,
    check: Some(words::GO_BACK),
    source: "Geometry",
    search: Search::FromPose(3),
    change_cable,
    ..Effect::NEUTRAL
};

fn cause(found: &FoundEffect<'_>) -> String {
    let shift_m = [0, 1, 2].map(|k| found.value(k));
    format!(
        "From {} on, {} {} displaced by {}.",
        found.pose(3),
        found.name(Part::Pulley),
        found.either("is", "are"),
        displacement(&shift_m),
    )
}

fn workshop(found: &FoundEffect<'_>) -> String {
    format!(
        "Check {} of {}, tighten the bolts and measure again.",
        found.either("the bracket", "the brackets"),
        found.name(Part::Pulley),
    )
}

fn change_cable(parameters: &[Dual], at: &CableContext, ports: &mut CablePorts) {
    if at.is_from(parameters[3].value) {
        for k in 0..3 {
            ports.entry_shift[k] += parameters[k];
        }
    }
}

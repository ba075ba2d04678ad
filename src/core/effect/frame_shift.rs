//! An entry point that jumps, as after a knock: `a += (x, y, z)`, base frame, metres, at the pose labelled `pose`
//! and at all later labels. Typical 1 to 20 mm.

use super::words;
use super::{AsText, CableContext, CablePorts, Dual, Effect, EffectParameter, Scope, Search};
use crate::measurement::Variable;

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
    cause: |found| found.say("From {3:pose} on, {pulley} {is|are} displaced by {displacement}."),
    workshop: |found| {
        found.say(
            "Check {the bracket|the brackets} of {pulley}, tighten the bolts and measure again.",
        )
    },
    check: Some(words::GO_BACK),
    source: "Geometry",
    search: Search::FromPose(3),
    change_cable,
    variable: Some(Variable::Time),
    is_damage: true,
    as_text: AsText::Formulas(&[
        ("entry_shift_x", "entry_shift_x + x * step(pose)"),
        ("entry_shift_y", "entry_shift_y + y * step(pose)"),
        ("entry_shift_z", "entry_shift_z + z * step(pose)"),
    ]),
    ..Effect::NEUTRAL
};

fn change_cable(parameters: &[Dual], at: &CableContext, ports: &mut CablePorts) {
    if at.is_from(parameters[3].value) {
        for k in 0..3 {
            ports.entry_shift[k] += parameters[k];
        }
    }
}

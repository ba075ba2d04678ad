//! Zero offset of a swivel angle: a constant added to its reading (rad). Typical 0.5 to 5 degrees.

use super::{AsText, Effect, EffectParameter, Scope};
use crate::measurement::Variable;

pub(super) static EFFECT: Effect = Effect {
    id: "swivel_offset",
    title: "Offset of a swivel angle",
    scope: Scope::Cable,
    parameters: &[EffectParameter::new("offset", "rad", 0.1, [0.0087, 0.087])
        .with_tolerance([0.002, 0.002], "Reference mark set by eye along an edge")],
    cause: |found| {
        found.say("The swivel {angle|angles} of {pulley} {reads|read} {0:deg} too {0:large|small}.")
    },
    workshop: |found| {
        found.say("Turn {pulley} to {its|their} reference direction and zero the swivel {encoder|encoders} again.")
    },
    check: Some("Turn the pulley to its zero mark and read its angle."),
    source: "Zero error of an angle encoder",
    change_cable: |parameters, _, ports| ports.swivel_offset += parameters[0],
    variable: Some(Variable::SwivelAngle),
    as_text: AsText::Formulas(&[("swivel_offset", "swivel_offset + offset")]),
    ..Effect::NEUTRAL
};

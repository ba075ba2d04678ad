//! A step in the cable paid out: `paid += step` at the pose labelled `pose` and at all later labels; metres.
//! Assumes that the cable slipped once. Typical 1 to 20 mm.

use super::words;
use super::{
    AsText, CableContext, CablePorts, Dual, Effect, EffectParameter, OnEachCable, Scope, Search,
};
use crate::measurement::Variable;

pub(super) static EFFECT: Effect = Effect {
    id: "cable_slip",
    title: "Cable slip on the drum",
    scope: Scope::Cable,
    parameters: &[
        EffectParameter::new("step", "m", 0.02, [0.001, 0.02]),
        EffectParameter::given("pose", "1", [1.0, 100.0]),
    ],
    cause: |found| {
        found.say("{cable} slipped: from {1:pose} on, {it is|they are} {0:mm} {0:longer|shorter} than {its reading says|their readings say}.")
    },
    workshop: |found| {
        found.say("Check how {cable} {is|are} fastened to the drum, and the coupling and the set screws of {winch}.{revolutions: Then zero the encoders at home again.|}")
    },
    on_each_cable: Some(OnEachCable {
        title: "New zeros of all winches",
        cause: "From {1:pose} on, the winches count from other zeros than before.",
        workshop: "Find out what happened before {1:pose}: were the winches zeroed again, did the controller restart, or was something at all cables moved? Measure the run again without it, or treat the poses before and after it as two runs.",
    }),
    check: Some(words::GO_BACK),
    source: "Geometry: one step in the cable paid out",
    search: Search::FromPose(1),
    change_cable,
    variable: Some(Variable::Time),
    is_damage: true,
    as_text: AsText::Formulas(&[("paid", "paid + step_change * step(pose)")]),
    ..Effect::NEUTRAL
};

fn change_cable(parameters: &[Dual], at: &CableContext, ports: &mut CablePorts) {
    if at.is_from(parameters[1].value) {
        ports.paid += parameters[0];
    }
}

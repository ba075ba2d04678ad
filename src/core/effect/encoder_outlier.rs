//! A single wrong length reading: the cable paid out, or the length, as read at the pose labelled `pose` contains
//! `error` (m).

use super::words;
use super::{AsText, CableContext, CablePorts, Dual, Effect, EffectParameter, Scope, Search};
use crate::measurement::Variable;

pub(super) static EFFECT: Effect = Effect {
    id: "encoder_outlier",
    title: "Outlier of an encoder",
    scope: Scope::Cable,
    parameters: &[
        EffectParameter::given("pose", "1", [1.0, 100.0]),
        EffectParameter::new("error", "m", 0.1, [0.005, 0.1]),
    ],
    cause: |found| {
        found.say("The length {reading|readings} of {cable} at {0:pose} {is|are} {1:mm} too {1:long|short}.")
    },
    workshop: |found| {
        found.say("Measure {0:pose} again, or leave the length {reading|readings} of {cable} out there. If it happens again, check encoder, plug and wiring of {winch}.")
    },
    check: Some(words::GO_THERE_AGAIN),
    source: "A single wrong reading",
    search: Search::AtPose(0),
    change_cable,
    variable: Some(Variable::Time),
    is_damage: true,
    as_text: AsText::Formulas(&[("paid", "paid - error * only(pose)")]),
    ..Effect::NEUTRAL
};

fn change_cable(parameters: &[Dual], at: &CableContext, ports: &mut CablePorts) {
    if at.is_at(parameters[0].value) {
        ports.paid += -parameters[1];
    }
}

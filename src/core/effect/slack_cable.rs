//! A cable that is slack at the pose labelled `pose`: it is longer by `amount` (m) than the distance that it spans, and pulls with
//! nothing. A diagnosis finds the poses itself and leaves the readings out, as nothing determines the amount.

use super::words;
use super::{
    AsText, BoundEffect, CableContext, CablePorts, Dual, Effect, EffectParameter, Scope, Search,
};
use crate::measurement::Variable;

pub(super) static EFFECT: Effect = Effect {
    id: "slack_cable",
    title: "Slack cable",
    scope: Scope::Cable,
    parameters: &[
        EffectParameter::given("pose", "1", [1.0, 100.0]),
        EffectParameter::new("amount", "m", 0.1, [0.002, 0.05]).within(0.0, f64::INFINITY),
    ],
    cause: |found| {
        found.say("{cable} {is|are} slack at {0:pose}, {1:mm} {1:longer|shorter} than the distance that {it spans|they span}.")
    },
    workshop: |found| {
        found.say("Raise the lower limit of tension, or plan poses at which {cable} {stays|stay} taut, and check that {winch} {follows|follow}.")
    },
    check: Some(words::GO_THERE_AGAIN),
    source: "One-sided contact: a cable cannot push",
    search: Search::AtPose(0),
    change_cable,
    variable: Some(Variable::Time),
    is_damage: true,
    as_text: AsText::Impossible(
        "makes the cable pull with nothing, so that the others carry the platform, while formulas change readings",
    ),
    ..Effect::NEUTRAL
};

fn change_cable(parameters: &[Dual], at: &CableContext, ports: &mut CablePorts) {
    if at.is_at(parameters[0].value) {
        ports.paid += -parameters[1];
    }
}

/// Whether an effect makes a cable slack at the pose with a label, where it pulls with nothing.
pub(crate) fn is_slack(bound: &BoundEffect, cable: usize, label: i64) -> bool {
    std::ptr::eq(bound.effect, &EFFECT)
        && bound.cables.contains(&cable)
        && bound.values[0] == label as f64
}

//! Scale of the distances between poses: each is read times `1 + scale`. Typical 0.05 to 1 %.

use super::{AsText, Effect, EffectParameter, Scope};

pub(super) static EFFECT: Effect = Effect {
    id: "tape_scale",
    title: "Scale of the tape",
    scope: Scope::Robot,
    parameters: &[EffectParameter::new("scale", "1", 0.01, [0.0005, 0.01])],
    cause: |found| found.say("The distances between poses are measured {0:%} too {0:long|short}."),
    workshop: |found| {
        found.say("Compare the tape with another one at its full length, and correct the distances by its scale.")
    },
    check: Some("Measure one of the distances with another tape."),
    source: "Scale error of distance meters",
    change_distance: |parameters, _, ports| ports.gain *= parameters[0] + 1.0,
    as_text: AsText::Impossible(
        "multiplies distances between poses, while formulas change readings of one pose",
    ),
    ..Effect::NEUTRAL
};

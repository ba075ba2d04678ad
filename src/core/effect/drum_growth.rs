//! Layers build up on the drum: `paid = k rev (1 + growth rev)` with revolutions of the motor. Typical
//! 0.01 to 1 % per revolution.

use super::{AsText, Effect, EffectParameter, Scope, Stage};
use crate::measurement::Variable;

pub(super) static EFFECT: Effect = Effect {
    id: "drum_growth",
    title: "Build-up of layers on the drum",
    scope: Scope::CableOrAll,
    parameters: &[
        EffectParameter::new("growth", "1/rev", 0.01, [0.00005, 0.01]).with_tolerance(
            [2e-06, 2e-06],
            "Taper of a drum of 0.01 mm over its length, over some tens of turns",
        ),
    ],
    cause: |found| {
        found.say("The {drum|drums} of {winch} {does|do} not have a constant diameter: the cable per revolution, on average since home, {0:rises|falls} by {0:%} with every motor revolution.")
    },
    workshop: |found| {
        found.say("Check that the cable lies in one layer and in regular turns on the {drum|drums} of {winch}, and guide it if it climbs over itself.")
    },
    check: Some("Measure the drum with calipers where it is bare and where it is full of cable."),
    source: "Geometry of a winding whose diameter changes in proportion to the turns, first order",
    stage: Stage::Ratio,
    change_cable: |parameters, at, ports| ports.paid *= parameters[0] * at.revolutions + 1.0,
    variable: Some(Variable::Revolutions),
    as_text: AsText::Formulas(&[("paid", "paid * (1 + growth * revolutions)")]),
    ..Effect::NEUTRAL
};

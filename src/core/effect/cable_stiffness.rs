//! Axial stiffness that differs from the stated one: `EA (1 + change)`. Typical 10 to 50 %.

use super::{AsText, Effect, EffectParameter, Scope};
use crate::measurement::Variable;

pub(super) static EFFECT: Effect = Effect {
    id: "cable_stiffness",
    title: "Cable stiffness",
    scope: Scope::CableOrAll,
    parameters: &[EffectParameter::new("change", "1", 0.5, [0.1, 0.5])
        .within(-0.9, 3.0)
        .with_tolerance(
            [0.05, 0.05],
            "Spread of the modulus of ropes between deliveries, stated as 5 to 10 %",
        )],
    cause: |found| found.say("{cable} {is|are} {0:%} {0:stiffer|less stiff} than stated."),
    workshop: |found| {
        found.say("Stretch a piece of the same cable with known weights, measure how much it stretches, and enter that stiffness.")
    },
    check: Some("Pull a piece of the cable with a known force and measure how much it stretches."),
    source: "Hooke's law; sizes from stiffnesses reported for ropes",
    change_cable: |parameters, _, ports| ports.compliance *= (parameters[0] + 1.0).recip(),
    variable: Some(Variable::Tension),
    as_text: AsText::Formulas(&[("compliance", "compliance / (1 + change)")]),
    ..Effect::NEUTRAL
};

//! Gain error of a force sensor: `F = g (1 + change) T + f0`, so `T = T_nominal / (1 + change)`. Typical 2 to 20 %.

use super::{AsText, Effect, EffectParameter, Scope, Stage};
use crate::measurement::Variable;

pub(super) static EFFECT: Effect = Effect {
    id: "force_gain",
    title: "Gain of the force sensors",
    scope: Scope::CableOrAll,
    parameters: &[EffectParameter::new("change", "1", 0.2, [0.02, 0.2])
        .within(-0.9, 2.0)
        .with_tolerance(
            [0.005, 0.005],
            "Load cells of 0.5 % accuracy class with their mounting",
        )],
    cause: |found| found.say("{force sensor} {reads|read} {0:%} too {0:high|low}."),
    workshop: |found| {
        found.say("Hang known weights on {cable} and calibrate the gain of {force sensor} again.")
    },
    check: Some("Hang a known weight from the cable and read its force sensor."),
    source: "Linear sensor: Jin et al., Sensors 18 (2018) 2392, section 3.2",
    stage: Stage::Ratio,
    change_cable: |parameters, _, ports| ports.tension *= (parameters[0] + 1.0).recip(),
    variable: Some(Variable::Tension),
    as_text: AsText::Formulas(&[("tension", "tension / (1 + change)")]),
    ..Effect::NEUTRAL
};

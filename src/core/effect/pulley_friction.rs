//! Friction of the cable on its pulley, or of the pulley in its bearing: `T_platform = T_sensor exp(mu theta dir)` with the
//! wrap angle `theta` (rad) and `dir` = +1 where the cable was paid out on the way to the pose, -1 where it
//! was reeled in, 0 at the first row.
//!
//! Approximations: `theta` is that of the nominal geometry at the commanded pose (or the tracker's, else the
//! home pose); the direction is that of the readings. Typical 0.005 to 0.1; 3 % of the tension for 90
//! degrees at 0.02. Source: belt friction (Euler, Eytelwein).

use super::words::{self, size};
use super::{AsText, Effect, EffectParameter, FoundEffect, Scope, Stage};
use crate::measurement::Variable;

pub(super) static EFFECT: Effect = Effect {
    id: "pulley_friction",
    title: "Pulley friction",
    scope: Scope::CableOrAll,
    parameters: &[EffectParameter::new("mu", "1", 0.1, [0.005, 0.1])
        .within(0.0, f64::INFINITY)
        .with_tolerance(
            [0.001, 0.001],
            "Friction of deep groove ball bearings of 0.0015 at the radius of the shaft, \
             and bending of the rope",
        )],
    cause,
    workshop: |found| {
        found.say("Clean and lubricate the {bearing|bearings} of {pulley}, and check that the cable runs freely in the groove.")
    },
    check: Some(words::GO_FROM_EITHER_SIDE),
    source: "Belt friction (Euler, Eytelwein)",
    stage: Stage::Ratio,
    change_cable: |parameters, at, ports| {
        ports.tension *= (parameters[0] * (at.wrap_rad * at.direction)).exp();
    },
    variable: Some(Variable::Direction),
    as_text: AsText::Formulas(&[("tension", "tension * exp(mu * wrap * direction)")]),
    ..Effect::NEUTRAL
};

fn cause(found: &FoundEffect<'_>) -> String {
    found.say_with(
        "{pulley} {rubs|rub} with a friction coefficient of {}: the tension at the platform is {0:higher|lower} than at the sensor after paying out, and {0:lower|higher} after reeling in.",
        &size(found.value(0)),
    )
}

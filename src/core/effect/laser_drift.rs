//! Warm-up drift: `a (1 - exp(-t / 900 s))` is added to the laser reading, `t` since home in seconds, `a` the
//! parameter `drift` in metres. Assumes that the laser was switched on at the home row. Typical 0.5 to 5 mm.

use super::{AsText, Effect, EffectParameter, Scope};
use crate::measurement::Variable;

pub(super) static EFFECT: Effect = Effect {
    id: "laser_drift",
    title: "Warm-up of the laser",
    scope: Scope::Robot,
    parameters: &[
        EffectParameter::new("drift", "m", 0.005, [0.0005, 0.005]).with_tolerance(
            [5e-05, 5e-05],
            "Warm-up of laser distance sensors after half an hour",
        ),
    ],
    cause: |found| {
        found.say("The laser drifts while it warms up: in the end it reads {0:mm} {0:longer|shorter} than when it was switched on.")
    },
    workshop: |found| found.say("Switch the laser on an hour before measuring."),
    check: Some(
        "Switch the laser on and watch its reading for half an hour while the platform stands still.",
    ),
    source: "Exponential warm-up of first order",
    change_platform: |parameters, at, ports| {
        ports.laser_bias += parameters[0] * -(-at.time_s.max(0.0) / 900.0).exp_m1();
    },
    variable: Some(Variable::Time),
    as_text: AsText::Formulas(&[(
        "laser_bias",
        "laser_bias + drift * (1 - exp(-max(time, 0) / 900 [s]))",
    )]),
    ..Effect::NEUTRAL
};

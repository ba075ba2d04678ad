//! Warm-up drift: `a (1 - exp(-t / 900 s))` is added to the laser reading, `t` since home in seconds, `a` the
//! parameter `drift` in metres. Assumes that the laser was switched on at the home row. Typical 0.5 to 5 mm.

use super::{Dual, Effect, EffectParameter, FoundEffect, PlatformContext, PlatformPorts, Scope};

pub(super) static EFFECT: Effect = Effect {
    id: "laser_drift",
    title: "Warm-up of the laser",
    scope: Scope::Robot,
    parameters: &[EffectParameter::new("drift", "m", 0.005, [0.0005, 0.005])],
    cause,
    workshop,
    check: Some(
        "Switch the laser on and watch its reading for half an hour while the platform stands still.",
    ),
    source: "Exponential warm-up of first order",
    change_platform,
    ..Effect::NEUTRAL
};

fn cause(found: &FoundEffect<'_>) -> String {
    format!(
        "The laser drifts while it warms up: in the end it reads {} {} than when it was switched on.",
        found.millimetres(0),
        found.way(0, "longer", "shorter"),
    )
}

fn workshop(_found: &FoundEffect<'_>) -> String {
    "Switch the laser on an hour before measuring.".to_owned()
}

fn change_platform(parameters: &[Dual], at: &PlatformContext, ports: &mut PlatformPorts) {
    ports.laser_bias += parameters[0] * -(-at.time_s.max(0.0) / 900.0).exp_m1();
}

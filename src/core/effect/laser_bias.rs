//! A constant added to every laser reading. Typical 0.5 to 5 mm; not separable from the offset of the
//! target plane.

use super::{Dual, Effect, EffectParameter, FoundEffect, PlatformContext, PlatformPorts, Scope};

pub(super) static EFFECT: Effect = Effect {
    id: "laser_bias",
    title: "Laser bias",
    scope: Scope::Robot,
    parameters: &[EffectParameter::new("bias", "m", 0.005, [0.0005, 0.005])],
    cause,
    workshop,
    check: Some("Measure one distance from the laser to its target with a steel tape."),
    source: "Zero error of distance meters",
    change_platform,
    ..Effect::NEUTRAL
};

fn cause(found: &FoundEffect<'_>) -> String {
    format!(
        "The laser reads {} too {} at every pose.",
        found.millimetres(0),
        found.way(0, "long", "short"),
    )
}

fn workshop(_found: &FoundEffect<'_>) -> String {
    "Check where the laser sits on the platform, and where the target is: a displaced target looks the same.".to_owned()
}

fn change_platform(parameters: &[Dual], _at: &PlatformContext, ports: &mut PlatformPorts) {
    ports.laser_bias += parameters[0];
}

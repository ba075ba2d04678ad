//! Laser reading times `1 + scale`. Typical 0.05 to 1 %.

use super::{Dual, Effect, EffectParameter, FoundEffect, PlatformContext, PlatformPorts, Scope};

pub(super) static EFFECT: Effect = Effect {
    id: "laser_scale",
    title: "Laser scale",
    scope: Scope::Robot,
    parameters: &[EffectParameter::new("scale", "1", 0.01, [0.0005, 0.01])],
    cause,
    workshop,
    check: Some("Measure one distance from the laser to its target with a steel tape."),
    source: "Scale error of distance meters",
    change_platform,
    ..Effect::NEUTRAL
};

fn cause(found: &FoundEffect<'_>) -> String {
    format!(
        "The laser reads distances {} too {}.",
        found.percent(0),
        found.way(0, "long", "short"),
    )
}

fn workshop(_found: &FoundEffect<'_>) -> String {
    "Compare the laser with a tape measure at two distances far apart, and correct its scale."
        .to_owned()
}

fn change_platform(parameters: &[Dual], _at: &PlatformContext, ports: &mut PlatformPorts) {
    ports.laser_gain *= parameters[0] + 1.0;
}

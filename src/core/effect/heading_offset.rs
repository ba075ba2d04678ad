//! A constant added to the yaw reading (rad), as by a compass that counts from elsewhere. Typical 1 to 180
//! degrees.

use super::{Dual, Effect, EffectParameter, FoundEffect, PlatformContext, PlatformPorts, Scope};

pub(super) static EFFECT: Effect = Effect {
    id: "heading_offset",
    title: "Heading offset",
    scope: Scope::Robot,
    parameters: &[EffectParameter::new(
        "offset",
        "rad",
        3.0,
        [0.017, std::f64::consts::PI],
    )],
    cause,
    workshop,
    check: Some("Align the platform with the frame and read its heading."),
    source: "Zero error of an attitude sensor",
    change_platform,
    ..Effect::NEUTRAL
};

fn cause(found: &FoundEffect<'_>) -> String {
    format!(
        "The yaw reading of the platform is {} too {}.",
        found.degrees(0),
        found.way(0, "large", "small"),
    )
}

fn workshop(_found: &FoundEffect<'_>) -> String {
    "Zero the heading at the home pose again. Keep a compass away from motors and steel.".to_owned()
}

fn change_platform(parameters: &[Dual], _at: &PlatformContext, ports: &mut PlatformPorts) {
    ports.inclination_offset[2] += parameters[0];
}

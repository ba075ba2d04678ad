//! Tilted normal of the reflector plane: rotated by `tilt_1`, then by `tilt_2` (rad), about two axes of the base frame
//! perpendicular to the nominal normal. The plane keeps its distance from the origin of the base frame.
//! The first is the base axis most nearly perpendicular to the normal, projected, the second completes the
//! right-handed triple (normal, first, second). Typical 0.2 to 2 degrees.

use super::direction::tilted;
use super::words::inclination;
use super::{
    AsText, Dual, Effect, EffectParameter, FoundEffect, PlatformContext, PlatformPorts, Scope,
};

/// Standard deviations of sound parts, for small and large machines.
const TOLERANCE: [f64; 2] = [0.0015, 0.0015];
const SOURCE_OF_TOLERANCE: &str = "Angles of long edges by ISO 2768-1 medium: 10 arc minutes";

pub(super) static EFFECT: Effect = Effect {
    id: "target_tilt",
    title: "Tilted target plane",
    scope: Scope::Robot,
    parameters: &[
        EffectParameter::new("tilt_1", "rad", 0.035, [0.0035, 0.035])
            .with_tolerance(TOLERANCE, SOURCE_OF_TOLERANCE),
        EffectParameter::new("tilt_2", "rad", 0.035, [0.0035, 0.035])
            .with_tolerance(TOLERANCE, SOURCE_OF_TOLERANCE),
    ],
    cause,
    workshop: |found| found.say("Check the target with a spirit level or a square, and align it."),
    check: Some("Put a spirit level on the target of the laser."),
    source: "Geometry",
    change_platform,
    as_text: AsText::Impossible(
        "turns a direction, whose components must keep their common length",
    ),
    ..Effect::NEUTRAL
};

fn cause(found: &FoundEffect<'_>) -> String {
    let stated = found.robot().laser.map(|laser| laser.target_plane.normal);
    let tilt = inclination(stated, found.value(0), found.value(1));
    format!("The target of the laser is not square: its normal is tilted by {tilt}.")
}

fn change_platform(parameters: &[Dual], at: &PlatformContext, ports: &mut PlatformPorts) {
    ports.target_normal = tilted(
        ports.target_normal,
        at.target_normal,
        parameters[0],
        parameters[1],
    );
}

//! Tilted beam direction: rotated by `tilt_1`, then by `tilt_2` (rad), about two axes of the platform perpendicular to the
//! nominal beam. The first is the platform axis most nearly perpendicular to it, projected, the second completes
//! the right-handed triple (beam, first, second). The origin stays. Typical 0.2 to 2 degrees; a cosine error
//! of 0.15 mm/m at one degree.

use super::direction::tilted;
use super::words::inclination;
use super::{
    AsText, Dual, Effect, EffectParameter, FoundEffect, PlatformContext, PlatformPorts, Scope,
};

/// Standard deviations of sound parts, for small and large machines.
const TOLERANCE: [f64; 2] = [0.002, 0.002];
const SOURCE_OF_TOLERANCE: &str =
    "Beam to housing and mounting face, by data sheets some milliradians";

pub(super) static EFFECT: Effect = Effect {
    id: "laser_beam_tilt",
    title: "Tilted laser beam",
    scope: Scope::Robot,
    parameters: &[
        EffectParameter::new("tilt_1", "rad", 0.035, [0.0035, 0.035])
            .with_tolerance(TOLERANCE, SOURCE_OF_TOLERANCE),
        EffectParameter::new("tilt_2", "rad", 0.035, [0.0035, 0.035])
            .with_tolerance(TOLERANCE, SOURCE_OF_TOLERANCE),
    ],
    cause,
    workshop: |found| {
        found.say("Check the screws of the laser's mount, and align the beam with a square on the platform.")
    },
    check: Some(
        "Move the platform straight up and see whether the laser spot wanders on its target.",
    ),
    source: "Geometry; cosine error of distance sensors, 0.15 mm/m at one degree",
    change_platform,
    as_text: AsText::Impossible(
        "turns a direction, whose components must keep their common length",
    ),
    ..Effect::NEUTRAL
};

fn cause(found: &FoundEffect<'_>) -> String {
    let stated = found.robot().laser.map(|laser| laser.direction);
    let tilt = inclination(stated, found.value(0), found.value(1));
    format!("The laser beam is tilted by {tilt} (platform axes).")
}

fn change_platform(parameters: &[Dual], at: &PlatformContext, ports: &mut PlatformPorts) {
    ports.laser_direction = tilted(
        ports.laser_direction,
        at.laser_direction,
        parameters[0],
        parameters[1],
    );
}

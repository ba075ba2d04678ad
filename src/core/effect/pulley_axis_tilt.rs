//! Tilted swivel axis: rotated by `tilt_1`, then by `tilt_2` (rad), about two fixed axes perpendicular to its nominal direction.
//! The first is the base axis most nearly perpendicular to the swivel axis, projected, the second completes the
//! right-handed triple (swivel axis, first, second). The entry point stays. Typical 1 to 10 degrees.

use super::direction::tilted;
use super::words::inclination;
use super::{AsText, Effect, EffectParameter, FoundEffect, Scope};
use crate::measurement::Variable;

/// Standard deviations of sound parts, for small and large machines.
const TOLERANCE: [f64; 2] = [0.004, 0.004];
const SOURCE_OF_TOLERANCE: &str =
    "Angles of short edges by ISO 2768-1 medium: 20 to 30 arc minutes";

pub(super) static EFFECT: Effect = Effect {
    id: "pulley_axis_tilt",
    title: "Tilted pulley",
    scope: Scope::Cable,
    parameters: &[
        EffectParameter::new("tilt_1", "rad", 0.17, [0.017, 0.17])
            .with_tolerance(TOLERANCE, SOURCE_OF_TOLERANCE),
        EffectParameter::new("tilt_2", "rad", 0.17, [0.017, 0.17])
            .with_tolerance(TOLERANCE, SOURCE_OF_TOLERANCE),
    ],
    cause,
    workshop: |found| {
        found.say("Check the {bracket|brackets} of {pulley} with a square or a spirit level, and align the swivel axis with the arriving cable.")
    },
    check: Some("Hold a spirit level against the swivel axis of the pulley."),
    source: "Geometry",
    change_cable: |parameters, at, ports| {
        ports.axis = tilted(ports.axis, at.swivel_axis, parameters[0], parameters[1]);
    },
    variable: Some(Variable::SwivelAngle),
    as_text: AsText::Impossible(
        "turns a direction, whose components must keep their common length",
    ),
    ..Effect::NEUTRAL
};

fn cause(found: &FoundEffect<'_>) -> String {
    // The axis points along the arriving cable; pulleys with different axes have no tilt direction in common.
    let stated = found.common(|index| found.robot().cables[index].pulley.swivel_axis);
    found.say_with(
        "The swivel {axis|axes} of {pulley}, along the arriving cable, {is|are} tilted by {}.",
        &inclination(stated, found.value(0), found.value(1)),
    )
}

//! A constant added to the yaw reading (rad), as by a compass with another zero direction. Typical 1 to 180
//! degrees.

use super::{AsText, Effect, EffectParameter, Scope};

pub(super) static EFFECT: Effect = Effect {
    id: "heading_offset",
    title: "Heading offset",
    scope: Scope::Robot,
    parameters: &[
        EffectParameter::new("offset", "rad", 3.0, [0.017, std::f64::consts::PI]).with_tolerance(
            [0.002, 0.002],
            "Reference direction set along an edge of the platform",
        ),
    ],
    cause: |found| found.say("The yaw reading of the platform is {0:deg} too {0:large|small}."),
    workshop: |found| {
        found.say(
            "Zero the heading at the home pose again. Keep a compass away from motors and steel.",
        )
    },
    check: Some("Align the platform with the frame and read its heading."),
    source: "Zero error of an attitude sensor",
    change_platform: |parameters, _, ports| ports.inclination_offset[2] += parameters[0],
    as_text: AsText::Formulas(&[("yaw_offset", "yaw_offset + offset")]),
    ..Effect::NEUTRAL
};

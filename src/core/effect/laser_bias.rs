//! A constant added to every laser reading. Typical 0.5 to 5 mm; not separable from the offset of the
//! target plane.

use super::{AsText, Effect, EffectParameter, Scope};

pub(super) static EFFECT: Effect = Effect {
    id: "laser_bias",
    title: "Laser bias",
    scope: Scope::Robot,
    parameters: &[
        EffectParameter::new("bias", "m", 0.005, [0.0005, 0.005]).with_tolerance(
            [0.0002, 0.0002],
            "Offset of laser distance sensors between targets of different colour",
        ),
    ],
    cause: |found| found.say("The laser reads {0:mm} too {0:long|short} at every pose."),
    workshop: |found| {
        found.say("Check where the laser sits on the platform, and where the target is: a displaced target looks the same.")
    },
    check: Some("Measure one distance from the laser to its target with a steel tape."),
    source: "Zero error of distance meters",
    change_platform: |parameters, _, ports| ports.laser_bias += parameters[0],
    as_text: AsText::Formulas(&[("laser_bias", "laser_bias + bias")]),
    ..Effect::NEUTRAL
};

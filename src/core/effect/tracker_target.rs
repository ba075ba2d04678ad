//! Displaced target of the external instrument: it measures the point `(x, y, z)`, platform frame, metres, instead of the
//! platform's origin: a reflector or the centroid of some markers. Typical 1 to 20 mm where the point was measured by hand.

use super::{AsText, Effect, EffectParameter, Scope};

pub(super) static EFFECT: Effect = Effect {
    id: "tracker_target",
    title: "Target of the external instrument",
    scope: Scope::Robot,
    parameters: &[
        EffectParameter::new("x", "m", 0.1, [0.001, 0.02]),
        EffectParameter::new("y", "m", 0.1, [0.001, 0.02]),
        EffectParameter::new("z", "m", 0.1, [0.001, 0.02]),
    ],
    cause: |found| {
        found.say("The point that the external instrument measures is off by {displacement} on the platform (platform axes).")
    },
    workshop: |found| {
        found.say("Measure on the platform where the reflector or the markers are, and enter that point in the external instrument.")
    },
    check: Some(
        "Turn the platform where it is: the measured point moves if it is not the platform's origin.",
    ),
    source: "Geometry",
    change_platform: |parameters, _, ports| {
        for k in 0..3 {
            ports.tracker_point[k] += parameters[k];
        }
    },
    as_text: AsText::Formulas(&[
        ("tracker_point_x", "tracker_point_x + x"),
        ("tracker_point_y", "tracker_point_y + y"),
        ("tracker_point_z", "tracker_point_z + z"),
    ]),
    ..Effect::NEUTRAL
};

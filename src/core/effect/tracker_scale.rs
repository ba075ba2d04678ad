//! Scale of the external instrument: it reads `(1 + scale) x` for the point `x` of the base frame, as a camera does whose printed
//! grid has another size than stated. The scale is removed from the reading, as in [`super::tracker_frame`]. Typical 0.05 to 0.5 %; more than 1 % would be seen at once.

use super::{AsText, Effect, EffectParameter, Scope};

pub(super) static EFFECT: Effect = Effect {
    id: "tracker_scale",
    title: "Scale of the external instrument",
    scope: Scope::Robot,
    parameters: &[EffectParameter::new("scale", "1", 0.02, [0.0005, 0.005]).within(-0.01, 0.01)],
    cause: |found| {
        found.say("The external instrument reads all distances {0:%} too {0:long|short}.")
    },
    workshop: |found| {
        found.say("Measure a long known distance with the external instrument, such as two marks far apart on its grid, and correct its scale.")
    },
    check: Some(CHECK),
    source: "Scale of a coordinate system",
    change_platform: |parameters, at, ports| {
        let scale = parameters[0];
        for (shift, read) in ports.tracker_shift.iter_mut().zip(at.tracked_m) {
            *shift += scale / (scale + 1.0) * read;
        }
    },
    as_text: AsText::Formulas(&[
        (
            "tracker_shift_x",
            "tracker_shift_x + tracked_x * scale / (1 + scale)",
        ),
        (
            "tracker_shift_y",
            "tracker_shift_y + tracked_y * scale / (1 + scale)",
        ),
        (
            "tracker_shift_z",
            "tracker_shift_z + tracked_z * scale / (1 + scale)",
        ),
    ]),
    ..Effect::NEUTRAL
};

/// Check that tells a scale of the instrument from a common scale of all winches.
pub(super) const CHECK: &str =
    "Measure one distance between two poses of the platform with a steel tape.";

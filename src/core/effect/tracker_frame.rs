//! Misaligned frame of the external instrument: it reads `t + R_f x` for the point `x` of the base frame, with
//! the shift `t` in metres and the rotation `R_f` by Rodrigues' parameters, half the turn in radians. Both are removed from the
//! reading; the correction is added to the prediction instead, so that only weights that differ by axis ignore it. Typical
//! 1 to 20 mm and 0.05 to 1 degree after an alignment by hand.

use super::direction::{rotated, rotation_row};
use super::words::{displacement, turn};
use super::{
    AsText, Dual, Effect, EffectParameter, FoundEffect, PlatformContext, PlatformPorts, Scope,
};

pub(super) static EFFECT: Effect = Effect {
    id: "tracker_frame",
    title: "Frame of the external instrument",
    scope: Scope::Robot,
    parameters: &[
        EffectParameter::new("shift_x", "m", 0.1, [0.001, 0.02]),
        EffectParameter::new("shift_y", "m", 0.1, [0.001, 0.02]),
        EffectParameter::new("shift_z", "m", 0.1, [0.001, 0.02]),
        EffectParameter::new("turn_x", "rad", 0.05, [0.001, 0.017]),
        EffectParameter::new("turn_y", "rad", 0.05, [0.001, 0.017]),
        EffectParameter::new("turn_z", "rad", 0.05, [0.001, 0.017]),
    ],
    cause,
    workshop: |found| {
        found.say("Measure the reference points of the robot's frame with the external instrument again, and align it to them.")
    },
    check: Some(
        "Measure three fixed points of the robot's frame with the external instrument, and compare them with their coordinates.",
    ),
    source: "Rigid transformation between two frames",
    change_platform,
    as_text: AsText::Impossible("composes rotations, which formulas of single quantities do not"),
    ..Effect::NEUTRAL
};

fn cause(found: &FoundEffect<'_>) -> String {
    let values: Vec<f64> = (0..6).map(|k| found.value(k)).collect();
    format!(
        "The external instrument is not aligned with the robot's frame: its readings are shifted by {} and turned by {}.",
        displacement(&values[..3]),
        turn(&values[3..])
    )
}

pub(super) fn change_platform(
    parameters: &[Dual],
    at: &PlatformContext,
    ports: &mut PlatformPorts,
) {
    let turn = [parameters[3], parameters[4], parameters[5]];
    let shifted: [Dual; 3] = std::array::from_fn(|k| -parameters[k] + at.tracked_m[k]);
    let in_robot = rotated(shifted, turn.map(|angle| -angle));
    let row = rotation_row(turn);
    for k in 0..3 {
        ports.tracker_shift[k] += -in_robot[k] + at.tracked_m[k];
        ports.tracker_turn[k] += row[k];
    }
}

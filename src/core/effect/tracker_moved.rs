//! External instrument that is moved, as a camera that somebody touches: from the pose labelled `pose` on, its frame is shifted and
//! turned as that of [`super::tracker_frame`]. Typical 1 to 20 mm and 0.05 to 1 degree.

use super::words::{self, displacement, turn};
use super::{
    AsText, Dual, Effect, EffectParameter, FoundEffect, PlatformContext, PlatformPorts, Scope,
    Search, tracker_frame,
};
use crate::measurement::Variable;

pub(super) static EFFECT: Effect = Effect {
    id: "tracker_moved",
    title: "External instrument moved during the measurement",
    scope: Scope::Robot,
    parameters: &[
        EffectParameter::new("shift_x", "m", 0.1, [0.001, 0.02]),
        EffectParameter::new("shift_y", "m", 0.1, [0.001, 0.02]),
        EffectParameter::new("shift_z", "m", 0.1, [0.001, 0.02]),
        EffectParameter::new("turn_x", "rad", 0.05, [0.001, 0.017]),
        EffectParameter::new("turn_y", "rad", 0.05, [0.001, 0.017]),
        EffectParameter::new("turn_z", "rad", 0.05, [0.001, 0.017]),
        EffectParameter::given("pose", "1", [1.0, 100.0]),
    ],
    cause,
    workshop: |found| {
        found.say("Fasten the external instrument and align it again, or leave its readings from {6:pose} on out.")
    },
    check: Some(words::GO_BACK),
    source: "Rigid transformation between two frames",
    search: Search::FromPose(6),
    change_platform,
    variable: Some(Variable::Time),
    is_damage: true,
    as_text: AsText::Impossible("composes rotations, which formulas of single quantities do not"),
    ..Effect::NEUTRAL
};

fn cause(found: &FoundEffect<'_>) -> String {
    let values: Vec<f64> = (0..6).map(|k| found.value(k)).collect();
    let inserted = format!(
        "shifted by {} and turned by {}",
        displacement(&values[..3]),
        turn(&values[3..])
    );
    found.say_with(
        "The external instrument was moved: from {6:pose} on, its readings are {}.",
        &inserted,
    )
}

fn change_platform(parameters: &[Dual], at: &PlatformContext, ports: &mut PlatformPorts) {
    if at.is_from(parameters[6].value) {
        tracker_frame::change_platform(&parameters[..6], at, ports);
    }
}

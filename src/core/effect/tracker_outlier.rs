//! A single wrong position of the external instrument: `(x, y, z)`, base frame, metres, is added to its reading at the pose labelled
//! `pose`, as by a tape that was misread.

use super::words;
use super::{AsText, Dual, Effect, EffectParameter, PlatformContext, PlatformPorts, Scope, Search};
use crate::measurement::Variable;

pub(super) static EFFECT: Effect = Effect {
    id: "tracker_outlier",
    title: "Outlier of the external instrument",
    scope: Scope::Robot,
    parameters: &[
        EffectParameter::new("x", "m", 0.1, [0.005, 0.1]),
        EffectParameter::new("y", "m", 0.1, [0.005, 0.1]),
        EffectParameter::new("z", "m", 0.1, [0.005, 0.1]),
        EffectParameter::given("pose", "1", [1.0, 100.0]),
    ],
    cause: |found| found.say("The position measured at {3:pose} is off by {displacement}."),
    workshop: |found| {
        found.say(
            "Measure {3:pose} again with the external instrument, or leave its reading out there.",
        )
    },
    check: Some(words::GO_THERE_AGAIN),
    source: "A single wrong reading",
    search: Search::AtPose(3),
    change_platform,
    variable: Some(Variable::Time),
    is_damage: true,
    as_text: AsText::Formulas(&[
        ("tracker_shift_x", "tracker_shift_x + x * only(pose)"),
        ("tracker_shift_y", "tracker_shift_y + y * only(pose)"),
        ("tracker_shift_z", "tracker_shift_z + z * only(pose)"),
    ]),
    ..Effect::NEUTRAL
};

fn change_platform(parameters: &[Dual], at: &PlatformContext, ports: &mut PlatformPorts) {
    if at.is_at(parameters[3].value) {
        for k in 0..3 {
            ports.tracker_shift[k] += parameters[k];
        }
    }
}

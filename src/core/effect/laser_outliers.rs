//! A single wrong laser reading: `error` (m) is added at the pose labelled `pose`, as by a stray reflection.
//! For several poses, state the effect several times.

use super::words;
use super::{AsText, Dual, Effect, EffectParameter, PlatformContext, PlatformPorts, Scope, Search};
use crate::measurement::Variable;

pub(super) static EFFECT: Effect = Effect {
    id: "laser_outliers",
    title: "Outlier of the laser",
    scope: Scope::Robot,
    parameters: &[
        EffectParameter::given("pose", "1", [1.0, 100.0]),
        EffectParameter::new("error", "m", 0.1, [0.005, 0.1]),
    ],
    cause: |found| found.say("The laser reading at {0:pose} is {1:mm} too {1:long|short}."),
    workshop: |found| {
        found.say("Check whether something stood in the beam at {0:pose} or the spot missed the target. Measure that pose again or leave its laser reading out.")
    },
    check: Some(words::GO_THERE_AGAIN),
    source: "A single wrong reading",
    search: Search::AtPose(0),
    change_platform,
    variable: Some(Variable::Time),
    is_damage: true,
    as_text: AsText::Formulas(&[("laser_bias", "laser_bias + error * only(pose)")]),
    ..Effect::NEUTRAL
};

fn change_platform(parameters: &[Dual], at: &PlatformContext, ports: &mut PlatformPorts) {
    if at.is_at(parameters[0].value) {
        ports.laser_bias += parameters[1];
    }
}

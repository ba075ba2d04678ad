//! Laser reading times `1 + scale`. Typical 0.05 to 1 %.

use super::{AsText, Effect, EffectParameter, Scope};
use crate::measurement::Variable;

pub(super) static EFFECT: Effect = Effect {
    id: "laser_scale",
    title: "Laser scale",
    scope: Scope::Robot,
    parameters: &[
        EffectParameter::new("scale", "1", 0.01, [0.0005, 0.01]).with_tolerance(
            [5e-05, 5e-05],
            "Linearity of laser distance sensors over their range",
        ),
    ],
    cause: |found| found.say("The laser reads distances {0:%} too {0:long|short}."),
    workshop: |found| {
        found.say("Compare the laser with a tape measure at two distances far apart, and correct its scale.")
    },
    check: Some("Measure one distance from the laser to its target with a steel tape."),
    source: "Scale error of distance meters",
    change_platform: |parameters, _, ports| ports.laser_gain *= parameters[0] + 1.0,
    variable: Some(Variable::Distance),
    as_text: AsText::Formulas(&[("laser_gain", "laser_gain * (1 + scale)")]),
    ..Effect::NEUTRAL
};

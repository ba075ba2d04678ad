//! A constant in the raw reading of a force sensor: `F = g T + f0 + bias` (N), so `T = T_nominal - bias / g`. Typical
//! 2 to 50 N.

use super::{AsText, CableContext, CablePorts, Dual, Effect, EffectParameter, Scope, Stage};
use crate::measurement::Variable;

pub(super) static EFFECT: Effect = Effect {
    id: "force_bias",
    title: "Bias of a force sensor",
    scope: Scope::Cable,
    parameters: &[
        EffectParameter::new("bias", "N", 50.0, [2.0, 50.0]).with_tolerance(
            [0.3, 3.0],
            "Zero of a load cell after taring: 0.03 % of 1 kN, of 10 kN on a large \
             machine",
        ),
    ],
    cause: |found| {
        found.say("{force sensor} {reads|read} {0:unit} too {0:high|low}, whatever the tension.")
    },
    workshop: |found| {
        found.say("Support the platform, slacken {cable} and zero {force sensor} again.")
    },
    check: Some("Slacken the cable and read its force sensor."),
    source: "Linear sensor: Jin et al., Sensors 18 (2018) 2392, section 3.2",
    stage: Stage::Sensor,
    change_cable,
    variable: Some(Variable::Tension),
    as_text: AsText::Formulas(&[("tension", "tension - bias / sensor_gain")]),
    ..Effect::NEUTRAL
};

fn change_cable(parameters: &[Dual], at: &CableContext, ports: &mut CablePorts) {
    if at.tension_gain != 0.0 {
        ports.tension += parameters[0] * -at.tension_gain.recip();
    }
}

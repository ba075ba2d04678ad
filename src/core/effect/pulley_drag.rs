//! Viscous friction: `T_platform = T_sensor + drag l'`, with the speed `l'` at which the
//! cable is paid out (m/s) and the drag in N s/m, from grease and fast bearings. Typical 1 to 50 N s/m. Motions of different
//! speed distinguish it from dry friction, which depends on the direction only.

use super::{AsText, Effect, EffectParameter, Scope};

pub(super) static EFFECT: Effect = Effect {
    id: "pulley_drag",
    title: "Viscous pulley friction",
    scope: Scope::CableOrAll,
    parameters: &[
        EffectParameter::new("drag", "N s/m", 50.0, [1.0, 50.0]).within(0.0, f64::INFINITY)
    ],
    cause: |found| {
        found.say("{pulley} {drags|drag} more the faster the cable runs: at 1 m/s the tension at the platform is {0:N} {0:higher|lower} than at the sensor while paying out.")
    },
    workshop: |found| {
        found.say("Check the grease and the seals of the {bearing|bearings} of {pulley}.")
    },
    check: Some("Move the cable at two speeds and compare the force readings."),
    source: "Viscous friction, in proportion to the speed",
    change_cable: |parameters, at, ports| ports.tension += parameters[0] * at.paid_rates[0],
    as_text: AsText::Formulas(&[("tension", "tension + drag * paid_rate")]),
    ..Effect::NEUTRAL
};

//! Pulley radius that differs from the stated one: `rp (1 + change)`. Typical 5 to 50 %.

use super::words::millimetres;
use super::{AsText, Effect, EffectParameter, FoundEffect, Scope};
use crate::measurement::Variable;

pub(super) static EFFECT: Effect = Effect {
    id: "pulley_radius",
    title: "Pulley radius",
    scope: Scope::CableOrAll,
    parameters: &[EffectParameter::new("change", "1", 0.5, [0.05, 0.5])
        .within(-0.9, 2.0)
        .with_tolerance(
            [0.005, 0.005],
            "Groove turned to ISO 2768-1 medium, and the spread of the cable diameter",
        )],
    cause,
    workshop: |found| {
        found.say("Measure the bottom of the groove of {pulley} with calipers, add the cable's diameter, and enter half the sum as the radius.")
    },
    check: Some("Measure the groove of the pulley with calipers."),
    source: "Geometry of a swivelling pulley: Jin et al., Sensors 18 (2018) 2392, equations 3 and 4",
    change_cable: |parameters, _, ports| ports.radius *= parameters[0] + 1.0,
    variable: Some(Variable::WrapAngle),
    as_text: AsText::Formulas(&[("radius", "radius * (1 + change)")]),
    ..Effect::NEUTRAL
};

fn cause(found: &FoundEffect<'_>) -> String {
    let stated = found.common(|index| found.robot().cables[index].pulley.radius_m);
    let radii = stated.filter(|radius| *radius > 0.0).map(|radius| {
        let [is, stated] = [radius * (1.0 + found.value(0)), radius].map(millimetres);
        format!(": {is} instead of {stated}")
    });
    found.say_with(
        "{pulley} {has|have} a radius {0:%} {0:larger|smaller} than stated{}.",
        &radii.unwrap_or_default(),
    )
}

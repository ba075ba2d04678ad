//! Pulley of another radius: `rp (1 + change)`. Typical 5 to 50 %.

use super::words::{millimetres, sentence};
use super::{CableContext, CablePorts, Dual, Effect, EffectParameter, FoundEffect, Part, Scope};

pub(super) static EFFECT: Effect = Effect {
    id: "pulley_radius",
    title: "Pulley radius",
    scope: Scope::CableOrAll,
    parameters: &[EffectParameter::new("change", "1", 0.5, [0.05, 0.5])],
    cause,
    workshop,
    check: Some("Measure the groove of the pulley with calipers."),
    source: "Geometry of a swivelling pulley: Jin et al., Sensors 18 (2018) 2392, equations 3 and 4",
    change_cable,
    ..Effect::NEUTRAL
};

fn cause(found: &FoundEffect<'_>) -> String {
    let stated = found.common(|index| found.robot().cables[index].pulley.radius_m);
    let radii = stated.filter(|radius| *radius > 0.0).map(|radius| {
        let [is, stated] = [radius * (1.0 + found.value(0)), radius].map(millimetres);
        format!(": {is} instead of {stated}")
    });
    sentence(&format!(
        "{} {} a radius {} {} than stated{}.",
        found.name(Part::Pulley),
        found.either("has", "have"),
        found.percent(0),
        found.way(0, "larger", "smaller"),
        radii.unwrap_or_default(),
    ))
}

fn workshop(found: &FoundEffect<'_>) -> String {
    format!(
        "Measure the bottom of the groove of {} with calipers, add the cable's diameter, and enter half of the sum as radius.",
        found.name(Part::Pulley),
    )
}

fn change_cable(parameters: &[Dual], _at: &CableContext, ports: &mut CablePorts) {
    ports.radius *= parameters[0] + 1.0;
}

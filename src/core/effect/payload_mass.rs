//! Mass of the platform that differs from the stated one: `m (1 + change)`, payload included. Observable through static equilibrium only: needs force
//! sensors on all cables. Typical 5 to 30 %.

use super::words::size;
use super::{AsText, Effect, EffectParameter, FoundEffect, Scope};

pub(super) static EFFECT: Effect = Effect {
    id: "payload_mass",
    title: "Mass of the platform",
    scope: Scope::Robot,
    parameters: &[EffectParameter::new("change", "1", 0.3, [0.05, 0.3])
        .within(-0.9, 2.0)
        .with_tolerance(
            [0.005, 0.01],
            "Platform weighed on a bench scale, or computed from its parts, and the \
             cables that it carries",
        )],
    cause,
    workshop: |found| {
        found.say("Weigh the platform with everything it carries, and enter that mass.")
    },
    check: Some("Weigh the platform on a scale, with everything it carries."),
    source: "Static equilibrium",
    change_platform: |parameters, _, ports| ports.mass *= parameters[0] + 1.0,
    as_text: AsText::Formulas(&[("mass", "mass * (1 + change)")]),
    ..Effect::NEUTRAL
};

fn cause(found: &FoundEffect<'_>) -> String {
    let stated_kg = found.robot().platform.mass_kg;
    let masses = stated_kg.map(|mass_kg| {
        let [is, stated] = [mass_kg * (1.0 + found.value(0)), mass_kg].map(size);
        format!(": {is} kg instead of {stated} kg")
    });
    found.say_with(
        "The platform is {0:%} {0:heavier|lighter} than stated{}.",
        &masses.unwrap_or_default(),
    )
}

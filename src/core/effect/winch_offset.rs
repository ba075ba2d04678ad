//! A constant added to the cable paid out at every pose but home, as when the encoder was zeroed with
//! the cable at another length. Typical 0.5 to 150 mm.

use super::{AsText, CableContext, CablePorts, Dual, Effect, EffectParameter, FoundEffect, Scope};

pub(super) static EFFECT: Effect = Effect {
    id: "winch_offset",
    title: "Winch offset",
    scope: Scope::CableOrAll,
    parameters: &[
        EffectParameter::new("offset", "m", 0.15, [0.0005, 0.15]).with_tolerance(
            [0.0002, 0.001],
            "Zero of a length reading, set with a gauge or on a large machine with a tape",
        ),
    ],
    cause: |found| {
        found.say("{cable} {is|are} {0:mm} {0:longer|shorter} than {its reading says|their readings say} at every pose{revolutions: but home|}.")
    },
    workshop,
    check: Some("Measure the length of the cable at one pose with a steel tape."),
    source: "Geometry: a zero set at another length; sizes from length errors reported for cable robots",
    change_cable,
    as_text: AsText::Formulas(&[("paid", "paid + offset * (1 - at_home)")]),
    ..Effect::NEUTRAL
};

fn workshop(found: &FoundEffect<'_>) -> String {
    found.say(if found.counts_revolutions() {
        "Drive to the home pose, bring {cable} to {its|their} usual tension and zero the {encoder|encoders} of {winch} again."
    } else {
        "Measure the length of {cable} with a tape at one pose and correct the zero of {its reading|their readings}."
    })
}

fn change_cable(parameters: &[Dual], at: &CableContext, ports: &mut CablePorts) {
    if !at.is_home {
        ports.paid += parameters[0];
    }
}

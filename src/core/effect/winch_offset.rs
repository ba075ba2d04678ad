//! A constant added to the cable paid out at every pose but home, as when the encoder was zeroed with
//! the cable at another length. Typical 0.5 to 150 mm.

use super::words::sentence;
use super::{CableContext, CablePorts, Dual, Effect, EffectParameter, FoundEffect, Part, Scope};

pub(super) static EFFECT: Effect = Effect {
    id: "winch_offset",
    title: "Winch offset",
    scope: Scope::CableOrAll,
    parameters: &[EffectParameter::new("offset", "m", 0.15, [0.0005, 0.15])],
    cause,
    workshop,
    check: Some("Measure the length of the cable at one pose with a steel tape."),
    source: "Geometry: a zero set at another length; sizes from length errors reported for cable robots",
    change_cable,
    ..Effect::NEUTRAL
};

fn cause(found: &FoundEffect<'_>) -> String {
    sentence(&format!(
        "{} {} {} {} than {} at every pose{}.",
        found.name(Part::Cable),
        found.either("is", "are"),
        found.millimetres(0),
        found.way(0, "longer", "shorter"),
        found.either("its reading says", "their readings say"),
        if found.counts_revolutions() {
            " but home"
        } else {
            ""
        },
    ))
}

fn workshop(found: &FoundEffect<'_>) -> String {
    if !found.counts_revolutions() {
        return format!(
            "Measure the length of {} with a tape at one pose and correct the zero of {}.",
            found.name(Part::Cable),
            found.either("its reading", "their readings"),
        );
    }
    format!(
        "Drive to the home pose, bring {} to {} usual tension and zero the {} of {} again.",
        found.name(Part::Cable),
        found.either("its", "their"),
        found.either("encoder", "encoders"),
        found.name(Part::Winch),
    )
}

fn change_cable(parameters: &[Dual], at: &CableContext, ports: &mut CablePorts) {
    if !at.is_home {
        ports.paid += parameters[0];
    }
}

//! A length reading that is wrong: `error` (m) is contained in the cable paid out, or in the length, that was read
//! at the pose labelled `pose`.

use super::words;
use super::{
    CableContext, CablePorts, Dual, Effect, EffectParameter, FoundEffect, Part, Scope, Search,
};

pub(super) static EFFECT: Effect = Effect {
    id: "encoder_outlier",
    title: "Outlier of an encoder",
    scope: Scope::Cable,
    parameters: &[
        EffectParameter::given("pose", "1", [1.0, 100.0]),
        EffectParameter::new("error", "m", 0.1, [0.005, 0.1]),
    ],
    cause,
    workshop,
    check: Some(words::GO_THERE_AGAIN),
    source: "A single wrong reading",
    search: Search::AtPose(0),
    change_cable,
    ..Effect::NEUTRAL
};

fn cause(found: &FoundEffect<'_>) -> String {
    format!(
        "The length {} of {} at {} {} {} too {}.",
        found.either("reading", "readings"),
        found.name(Part::Cable),
        found.pose(0),
        found.either("is", "are"),
        found.millimetres(1),
        found.way(1, "long", "short"),
    )
}

fn workshop(found: &FoundEffect<'_>) -> String {
    format!(
        "Measure {} again, or leave the length {} of {} out there. If it happens again, check encoder, plug and wiring of {}.",
        found.pose(0),
        found.either("reading", "readings"),
        found.name(Part::Cable),
        found.name(Part::Winch),
    )
}

fn change_cable(parameters: &[Dual], at: &CableContext, ports: &mut CablePorts) {
    if at.is_at(parameters[0].value) {
        ports.paid += -parameters[1];
    }
}

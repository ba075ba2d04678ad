//! A step in the cable paid out: `paid += step` at the pose labelled `pose` and at all later labels; metres.
//! Assumes that the cable slipped once. Typical 1 to 20 mm.

use super::words::{self, sentence};
use super::{
    CableContext, CablePorts, Dual, Effect, EffectParameter, FoundEffect, Part, Scope, Search,
};

pub(super) static EFFECT: Effect = Effect {
    id: "cable_slip",
    title: "Slip of a cable on its drum",
    scope: Scope::Cable,
    parameters: &[
        EffectParameter::new("step", "m", 0.02, [0.001, 0.02]),
        EffectParameter::given("pose", "1", [1.0, 100.0]),
    ],
    cause,
    workshop,
    check: Some(words::GO_BACK),
    source: "Geometry: one step in the cable paid out",
    search: Search::FromPose(1),
    change_cable,
    ..Effect::NEUTRAL
};

fn cause(found: &FoundEffect<'_>) -> String {
    sentence(&format!(
        "{} slipped: from {} on, {} {} {} than {}.",
        found.name(Part::Cable),
        found.pose(1),
        found.either("it is", "they are"),
        found.millimetres(0),
        found.way(0, "longer", "shorter"),
        found.either("its reading says", "their readings say"),
    ))
}

fn workshop(found: &FoundEffect<'_>) -> String {
    format!(
        "Check how {} {} fastened to the drum, and the coupling and the set screws of {}.{}",
        found.name(Part::Cable),
        found.either("is", "are"),
        found.name(Part::Winch),
        if found.counts_revolutions() {
            " Then zero the encoders at home again."
        } else {
            ""
        },
    )
}

fn change_cable(parameters: &[Dual], at: &CableContext, ports: &mut CablePorts) {
    if at.is_from(parameters[1].value) {
        ports.paid += parameters[0];
    }
}

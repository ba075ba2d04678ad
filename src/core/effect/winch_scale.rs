//! Drum of another effective diameter: cable per revolution times `1 + scale`; for absolute lengths
//! the length times `1 + scale`. Typical 0.1 to 3 % (winch ratio errors of cable robots).

use super::words::sentence;
use super::{
    CableContext, CablePorts, Dual, Effect, EffectParameter, FoundEffect, Part, Scope, Stage,
};

pub(super) static EFFECT: Effect = Effect {
    id: "winch_scale",
    title: "Winch scale",
    scope: Scope::Cable,
    parameters: &[EffectParameter::new("scale", "1", 0.03, [0.001, 0.03])],
    cause,
    workshop,
    check: Some(
        "Pay out a few metres of cable and compare what the controller counts with a steel tape.",
    ),
    source: "Geometry of a drum; sizes from winch ratio errors reported for cable robots",
    stage: Stage::Ratio,
    change_cable,
    ..Effect::NEUTRAL
};

pub(super) fn cause(found: &FoundEffect<'_>) -> String {
    let size = found.percent(0);
    if !found.counts_revolutions() {
        return sentence(&format!(
            "{} {} {size} {} than {}.",
            found.name(Part::Cable),
            found.either("is", "are"),
            found.way(0, "longer", "shorter"),
            found.either("its length reading says", "their length readings say"),
        ));
    }
    sentence(&format!(
        "{} {} {size} {} cable per revolution than {}.",
        found.name(Part::Winch),
        found.either("pays out", "pay out"),
        found.way(0, "more", "less"),
        found.either("its drum diameter says", "their drum diameters say"),
    ))
}

pub(super) fn workshop(found: &FoundEffect<'_>) -> String {
    if !found.counts_revolutions() {
        return format!(
            "Compare the length {} of {} with a tape measure at two lengths far apart, and correct the scale in the controller.",
            found.either("reading", "readings"),
            found.name(Part::Cable),
        );
    }
    format!(
        "Measure the {} of {} with calipers, cable layer included, and correct the drum {} in the controller. Check the gear ratio there, too.",
        found.either("drum", "drums"),
        found.name(Part::Winch),
        found.either("diameter", "diameters"),
    )
}

pub(super) fn change_cable(parameters: &[Dual], _at: &CableContext, ports: &mut CablePorts) {
    ports.paid *= parameters[0] + 1.0;
}

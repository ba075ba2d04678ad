//! Play between motor and drum: `paid += dir play / 2`, with `dir` = +1 where the cable was paid out on the
//! way to the pose and -1 where it was reeled in; metres.
//!
//! The direction is the sign of the change of the reading since the row before, 0 at the first row. So
//! it is wrong where a cable moved by less than the play; a simulation knows the true direction.
//! Typical 0.2 to 2 mm. Source: dead band of half the play to either side, as in any drive with play.

use super::words::{self, sentence};
use super::{CableContext, CablePorts, Dual, Effect, EffectParameter, FoundEffect, Part, Scope};

pub(super) static EFFECT: Effect = Effect {
    id: "winch_backlash",
    title: "Winch backlash",
    scope: Scope::CableOrAll,
    parameters: &[EffectParameter::new("play", "m", 0.002, [0.0002, 0.002])],
    cause,
    workshop,
    check: Some(words::GO_FROM_EITHER_SIDE),
    source: "Dead band of half the play to either side, as in any drive with play",
    change_cable,
    ..Effect::NEUTRAL
};

fn cause(found: &FoundEffect<'_>) -> String {
    sentence(&format!(
        "{} {} {} of play: at the same reading {} {} after paying out than after reeling in.",
        found.name(Part::Winch),
        found.either("has", "have"),
        found.millimetres(0),
        found.either("its cable is", "their cables are"),
        found.way(0, "longer", "shorter"),
    ))
}

fn workshop(found: &FoundEffect<'_>) -> String {
    format!(
        "Check the coupling, the set screws and the gearbox of {} for play. Until it is mended, approach poses always from the same side.",
        found.name(Part::Winch),
    )
}

fn change_cable(parameters: &[Dual], at: &CableContext, ports: &mut CablePorts) {
    ports.paid += parameters[0] * (0.5 * at.direction);
}

//! A constant added to the reading of a swivel angle (rad): its zero was set off. Typical 0.5 to 5 degrees.

use super::{CableContext, CablePorts, Dual, Effect, EffectParameter, FoundEffect, Part, Scope};

pub(super) static EFFECT: Effect = Effect {
    id: "swivel_offset",
    title: "Offset of a swivel angle",
    scope: Scope::Cable,
    parameters: &[EffectParameter::new("offset", "rad", 0.1, [0.0087, 0.087])],
    cause,
    workshop,
    check: Some("Turn the pulley to its zero mark and read its angle."),
    source: "Zero error of an angle encoder",
    change_cable,
    ..Effect::NEUTRAL
};

fn cause(found: &FoundEffect<'_>) -> String {
    format!(
        "The swivel {} of {} {} {} too {}.",
        found.either("angle", "angles"),
        found.name(Part::Pulley),
        found.either("reads", "read"),
        found.degrees(0),
        found.way(0, "large", "small"),
    )
}

fn workshop(found: &FoundEffect<'_>) -> String {
    format!(
        "Turn {} to {} reference direction and zero the swivel {} again.",
        found.name(Part::Pulley),
        found.either("its", "their"),
        found.either("encoder", "encoders"),
    )
}

fn change_cable(parameters: &[Dual], _at: &CableContext, ports: &mut CablePorts) {
    ports.swivel_offset += parameters[0];
}

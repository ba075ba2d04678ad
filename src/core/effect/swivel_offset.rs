//! A constant added to the reading of a swivel angle (rad): its zero was set off. Typical 0.5 to 5 degrees.

use super::{CableCircumstances, CablePorts, Dual, Effect, EffectParameter, Found, Part, Scope};

/// See the module documentation.
#[derive(Debug)]
pub struct SwivelOffset;

impl Effect for SwivelOffset {
    fn id(&self) -> &'static str {
        "swivel_offset"
    }
    fn title(&self) -> &'static str {
        "Offset of a swivel angle"
    }
    fn scope(&self) -> Scope {
        Scope::Cable
    }
    fn parameters(&self) -> &'static [EffectParameter] {
        const { &[EffectParameter::new("offset", "rad", 0.1, [0.0087, 0.087])] }
    }
    fn cause(&self, found: &Found<'_>) -> String {
        format!(
            "The swivel {} of {} {} {} too {}.",
            found.either("angle", "angles"),
            found.name(Part::Pulley),
            found.either("reads", "read"),
            found.degrees(0),
            found.way(0, "large", "small"),
        )
    }
    fn workshop(&self, found: &Found<'_>) -> String {
        format!(
            "Turn {} to {} reference direction and zero the swivel {} again.",
            found.name(Part::Pulley),
            found.either("its", "their"),
            found.either("encoder", "encoders"),
        )
    }
    fn check(&self) -> Option<&'static str> {
        Some("Turn the pulley to its zero mark and read its angle.")
    }
    fn source(&self) -> &'static str {
        "Zero error of an angle encoder"
    }
    fn change_cable(&self, parameters: &[Dual], _at: &CableCircumstances, ports: &mut CablePorts) {
        ports.swivel_offset += parameters[0];
    }
}

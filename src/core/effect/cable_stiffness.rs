//! Axial stiffness other than stated: `EA (1 + change)`. Typical 10 to 50 %.

use super::words::sentence;
use super::{CableCircumstances, CablePorts, Dual, Effect, EffectParameter, Found, Part, Scope};

/// See the module documentation.
#[derive(Debug)]
pub struct CableStiffness;

impl Effect for CableStiffness {
    fn id(&self) -> &'static str {
        "cable_stiffness"
    }
    fn title(&self) -> &'static str {
        "Cable stiffness"
    }
    fn scope(&self) -> Scope {
        Scope::CableOrAll
    }
    fn parameters(&self) -> &'static [EffectParameter] {
        const { &[EffectParameter::new("change", "1", 0.5, [0.1, 0.5])] }
    }
    fn cause(&self, found: &Found<'_>) -> String {
        sentence(&format!(
            "{} {} {} {} than stated.",
            found.name(Part::Cable),
            found.either("is", "are"),
            found.percent(0),
            found.way(0, "stiffer", "less stiff"),
        ))
    }
    fn workshop(&self, _found: &Found<'_>) -> String {
        "Stretch a piece of the same cable with known weights, measure by how much, and enter that stiffness.".to_owned()
    }
    fn check(&self) -> Option<&'static str> {
        Some("Pull a piece of the cable with a known force and measure by how much it gets longer.")
    }
    fn source(&self) -> &'static str {
        "Hooke's law; sizes from stiffnesses reported for ropes"
    }
    fn change_cable(&self, parameters: &[Dual], _at: &CableCircumstances, ports: &mut CablePorts) {
        ports.compliance *= (parameters[0] + 1.0).recip();
    }
}

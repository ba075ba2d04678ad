//! Axial stiffness other than stated: `EA (1 + change)`. Typical 10 to 50 %.

use super::{CableCircumstances, CablePorts, Dual, Effect, EffectParameter, Scope};

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
    fn change_cable(&self, parameters: &[Dual], _at: &CableCircumstances, ports: &mut CablePorts) {
        ports.compliance *= (parameters[0] + 1.0).recip();
    }
}

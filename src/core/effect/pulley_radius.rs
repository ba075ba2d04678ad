//! Pulley of another radius: `rp (1 + change)`. Typical 5 to 50 %.

use super::{CableCircumstances, CablePorts, Dual, Effect, EffectParameter, Scope};

/// See the module documentation.
#[derive(Debug)]
pub struct PulleyRadius;

impl Effect for PulleyRadius {
    fn id(&self) -> &'static str {
        "pulley_radius"
    }
    fn title(&self) -> &'static str {
        "Pulley radius"
    }
    fn scope(&self) -> Scope {
        Scope::CableOrAll
    }
    fn parameters(&self) -> &'static [EffectParameter] {
        const { &[EffectParameter::new("change", "1", 0.3, [0.05, 0.5])] }
    }
    fn change_cable(&self, parameters: &[Dual], _at: &CableCircumstances, ports: &mut CablePorts) {
        ports.radius *= parameters[0] + 1.0;
    }
}

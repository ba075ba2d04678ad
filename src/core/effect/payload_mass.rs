//! Platform of another mass: `m (1 + change)`, payload included. Seen through static equilibrium only: needs force
//! sensors on all cables. Typical 5 to 30 %.

use super::{Dual, Effect, EffectParameter, PlatformCircumstances, PlatformPorts, Scope};

/// See the module documentation.
#[derive(Debug)]
pub struct PayloadMass;

impl Effect for PayloadMass {
    fn id(&self) -> &'static str {
        "payload_mass"
    }
    fn title(&self) -> &'static str {
        "Mass of the platform"
    }
    fn scope(&self) -> Scope {
        Scope::Robot
    }
    fn parameters(&self) -> &'static [EffectParameter] {
        const { &[EffectParameter::new("change", "1", 0.3, [0.05, 0.3])] }
    }
    fn change_platform(
        &self,
        parameters: &[Dual],
        _at: &PlatformCircumstances,
        ports: &mut PlatformPorts,
    ) {
        ports.mass *= parameters[0] + 1.0;
    }
}

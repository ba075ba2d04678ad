//! Force sensor of another gain: `F = g (1 + change) T + f0`, so `T = T_nominal / (1 + change)`. Typical 2 to 20 %.

use super::{CableCircumstances, CablePorts, Dual, Effect, EffectParameter, Scope, Stage};

/// See the module documentation.
#[derive(Debug)]
pub struct ForceGain;

impl Effect for ForceGain {
    fn id(&self) -> &'static str {
        "force_gain"
    }
    fn title(&self) -> &'static str {
        "Gain of the force sensors"
    }
    fn scope(&self) -> Scope {
        Scope::CableOrAll
    }
    fn parameters(&self) -> &'static [EffectParameter] {
        const { &[EffectParameter::new("change", "1", 0.2, [0.02, 0.2])] }
    }
    fn stage(&self) -> Stage {
        Stage::Ratio
    }
    fn change_cable(&self, parameters: &[Dual], _at: &CableCircumstances, ports: &mut CablePorts) {
        ports.tension *= (parameters[0] + 1.0).recip();
    }
}

//! Strain that grows with the logarithm of time: `strain += c ln(1 + t / 600 s)`, `t` since home. Assumes that
//! the load is about constant. Typical 1e-4 to 1e-2: logarithmic creep of fibre ropes.

use super::{CableCircumstances, CablePorts, Dual, Effect, EffectParameter, Scope};

/// See the module documentation.
#[derive(Debug)]
pub struct CableCreep;

impl Effect for CableCreep {
    fn id(&self) -> &'static str {
        "cable_creep"
    }
    fn title(&self) -> &'static str {
        "Cable creep"
    }
    fn scope(&self) -> Scope {
        Scope::CableOrAll
    }
    fn parameters(&self) -> &'static [EffectParameter] {
        const { &[EffectParameter::new("c", "1", 0.01, [0.0001, 0.01])] }
    }
    fn change_cable(&self, parameters: &[Dual], at: &CableCircumstances, ports: &mut CablePorts) {
        ports.strain += parameters[0] * (at.time_s.max(0.0) / 600.0).ln_1p();
    }
}

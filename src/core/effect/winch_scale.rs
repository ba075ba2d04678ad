//! Drum of another effective diameter: cable per revolution times `1 + scale`; for absolute lengths
//! the length times `1 + scale`. Typical 0.1 to 3 % (winch ratio errors of cable robots).

use super::{CableCircumstances, CablePorts, Dual, Effect, EffectParameter, Scope, Stage};

/// See the module documentation.
#[derive(Debug)]
pub struct WinchScale;

impl Effect for WinchScale {
    fn id(&self) -> &'static str {
        "winch_scale"
    }
    fn title(&self) -> &'static str {
        "Winch scale"
    }
    fn scope(&self) -> Scope {
        Scope::Cable
    }
    fn parameters(&self) -> &'static [EffectParameter] {
        const { &[EffectParameter::new("scale", "1", 0.03, [0.001, 0.03])] }
    }
    fn stage(&self) -> Stage {
        Stage::Ratio
    }
    fn change_cable(&self, parameters: &[Dual], _at: &CableCircumstances, ports: &mut CablePorts) {
        ports.paid *= parameters[0] + 1.0;
    }
}

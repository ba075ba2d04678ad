//! All drums of another effective diameter by the same ratio, as by a wrong cable diameter: cable per
//! revolution times `1 + scale`. Typical 0.1 to 1 %.

use super::{CableCircumstances, CablePorts, Dual, Effect, EffectParameter, Scope, Stage};

/// See the module documentation.
#[derive(Debug)]
pub struct WinchScaleCommon;

impl Effect for WinchScaleCommon {
    fn id(&self) -> &'static str {
        "winch_scale_common"
    }
    fn title(&self) -> &'static str {
        "Winch scale common to all"
    }
    fn scope(&self) -> Scope {
        Scope::Robot
    }
    fn parameters(&self) -> &'static [EffectParameter] {
        const { &[EffectParameter::new("scale", "1", 0.01, [0.001, 0.01])] }
    }
    fn stage(&self) -> Stage {
        Stage::Ratio
    }
    fn change_cable(&self, parameters: &[Dual], _at: &CableCircumstances, ports: &mut CablePorts) {
        ports.paid *= parameters[0] + 1.0;
    }
}

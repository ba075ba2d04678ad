//! All drums of another effective diameter by the same ratio, as by a wrong cable diameter: cable per
//! revolution times `1 + scale`. Typical 0.1 to 1 %.

use super::{CableCircumstances, CablePorts, Dual, Effect, EffectParameter, Scope};

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
        &[EffectParameter {
            name: "scale",
            unit: "1",
            prior_sd: 0.01,
            typical: [0.001, 0.01],
        }]
    }
    fn change_cable(&self, parameters: &[Dual], _at: &CableCircumstances, ports: &mut CablePorts) {
        ports.paid *= parameters[0] + 1.0;
    }
}

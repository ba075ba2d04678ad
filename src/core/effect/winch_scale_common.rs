//! All drums of another effective diameter by the same ratio, as by a wrong cable diameter: cable per
//! revolution times `1 + scale`. Typical 0.1 to 1 %.

use super::winch_scale::WinchScale;
use super::{CableCircumstances, CablePorts, Dual, Effect, EffectParameter, Found, Scope, Stage};

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
    fn cause(&self, found: &Found<'_>) -> String {
        WinchScale.cause(found)
    }
    fn workshop(&self, found: &Found<'_>) -> String {
        if !found.counts_revolutions() {
            return WinchScale.workshop(found);
        }
        "Measure the drum and the cable of one winch with calipers and correct the drum diameter of all in the controller: it counts to the middle of the cable. Check the gear ratio there, too.".to_owned()
    }
    fn check(&self) -> Option<&'static str> {
        Some("Measure one distance between two poses of the platform with a steel tape.")
    }
    fn source(&self) -> &'static str {
        "Geometry of a drum; sizes from winch ratio errors reported for cable robots"
    }
    fn stage(&self) -> Stage {
        Stage::Ratio
    }
    fn change_cable(&self, parameters: &[Dual], _at: &CableCircumstances, ports: &mut CablePorts) {
        ports.paid *= parameters[0] + 1.0;
    }
}

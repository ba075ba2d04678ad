//! A step in the cable paid out: `paid += step` at the pose labelled `pose` and at all later labels; metres.
//! Assumes that the cable slipped once. Typical 1 to 20 mm.

use super::{CableCircumstances, CablePorts, Dual, Effect, EffectParameter, Scope, Search};

/// See the module documentation.
#[derive(Debug)]
pub struct CableSlip;

impl Effect for CableSlip {
    fn id(&self) -> &'static str {
        "cable_slip"
    }
    fn title(&self) -> &'static str {
        "Slip of a cable on its drum"
    }
    fn scope(&self) -> Scope {
        Scope::Cable
    }
    fn parameters(&self) -> &'static [EffectParameter] {
        const {
            &[
                EffectParameter::new("step", "m", 0.02, [0.001, 0.02]),
                EffectParameter::given("pose", "1", [1.0, 100.0]),
            ]
        }
    }
    fn search(&self) -> Search {
        Search::FromPose(1)
    }
    fn change_cable(&self, parameters: &[Dual], at: &CableCircumstances, ports: &mut CablePorts) {
        if at.is_from(parameters[1].value) {
            ports.paid += parameters[0];
        }
    }
}

//! An entry point that jumps, as after a knock: `a += (x, y, z)`, base frame, metres, at the pose labelled `pose`
//! and at all later labels. Typical 1 to 20 mm.

use super::words::{self, displacement};
use super::{
    CableCircumstances, CablePorts, Dual, Effect, EffectParameter, Found, Part, Scope, Search,
};

/// See the module documentation.
#[derive(Debug)]
pub struct FrameShift;

impl Effect for FrameShift {
    fn id(&self) -> &'static str {
        "frame_shift"
    }
    fn title(&self) -> &'static str {
        "Shift of a pulley during the measurement"
    }
    fn scope(&self) -> Scope {
        Scope::Cable
    }
    fn parameters(&self) -> &'static [EffectParameter] {
        const {
            &[
                EffectParameter::new("x", "m", 0.02, [0.001, 0.02]),
                EffectParameter::new("y", "m", 0.02, [0.001, 0.02]),
                EffectParameter::new("z", "m", 0.02, [0.001, 0.02]),
                EffectParameter::given("pose", "1", [1.0, 100.0]),
            ]
        }
    }
    fn cause(&self, found: &Found<'_>) -> String {
        let shift_m = [0, 1, 2].map(|k| found.value(k));
        format!(
            "From {} on, {} {} displaced by {}.",
            found.pose(3),
            found.name(Part::Pulley),
            found.either("is", "are"),
            displacement(&shift_m),
        )
    }
    fn workshop(&self, found: &Found<'_>) -> String {
        format!(
            "Check {} of {}, tighten the bolts and measure again.",
            found.either("the bracket", "the brackets"),
            found.name(Part::Pulley),
        )
    }
    fn check(&self) -> Option<&'static str> {
        Some(words::GO_BACK)
    }
    fn source(&self) -> &'static str {
        "Geometry"
    }
    fn search(&self) -> Search {
        Search::FromPose(3)
    }
    fn change_cable(&self, parameters: &[Dual], at: &CableCircumstances, ports: &mut CablePorts) {
        if at.is_from(parameters[3].value) {
            for k in 0..3 {
                ports.entry_shift[k] += parameters[k];
            }
        }
    }
}

//! Swivel axis tilted: turned by `tilt_1`, then by `tilt_2` (rad), about two fixed axes across its nominal direction. The first is
//! the base axis most nearly across the swivel axis, made exactly so, the second completes the
//! right-handed triple (swivel axis, first, second). The entry point stays. Typical 1 to 10 degrees.

use super::direction::tilted;
use super::{CableCircumstances, CablePorts, Dual, Effect, EffectParameter, Scope};

/// See the module documentation.
#[derive(Debug)]
pub struct PulleyAxisTilt;

impl Effect for PulleyAxisTilt {
    fn id(&self) -> &'static str {
        "pulley_axis_tilt"
    }
    fn title(&self) -> &'static str {
        "Tilted pulley"
    }
    fn scope(&self) -> Scope {
        Scope::Cable
    }
    fn parameters(&self) -> &'static [EffectParameter] {
        const {
            &[
                EffectParameter::new("tilt_1", "rad", 0.1, [0.017, 0.17]),
                EffectParameter::new("tilt_2", "rad", 0.1, [0.017, 0.17]),
            ]
        }
    }
    fn change_cable(&self, parameters: &[Dual], at: &CableCircumstances, ports: &mut CablePorts) {
        ports.axis = tilted(ports.axis, at.swivel_axis, parameters[0], parameters[1]);
    }
}

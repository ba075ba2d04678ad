//! A constant added to the cable paid out at every pose but home, as when the encoder was zeroed with
//! the cable at another length. Typical 0.5 to 150 mm.

use super::{CableCircumstances, CablePorts, Dual, Effect, EffectParameter, Scope};

/// See the module documentation.
#[derive(Debug)]
pub struct WinchOffset;

impl Effect for WinchOffset {
    fn id(&self) -> &'static str {
        "winch_offset"
    }
    fn title(&self) -> &'static str {
        "Winch offset"
    }
    fn scope(&self) -> Scope {
        Scope::CableOrAll
    }
    fn parameters(&self) -> &'static [EffectParameter] {
        const { &[EffectParameter::new("offset", "m", 0.1, [0.0005, 0.15])] }
    }
    fn change_cable(&self, parameters: &[Dual], at: &CableCircumstances, ports: &mut CablePorts) {
        if !at.is_home {
            ports.paid += parameters[0];
        }
    }
}

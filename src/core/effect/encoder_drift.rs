//! A length reading that drifts: `paid += rate t / 3600`, with the time `t` since home in seconds and the
//! rate in metres per hour. Assumes a constant rate. Typical 1 to 10 mm/h: slip that adds up, or a
//! reference that wanders.

use super::{CableCircumstances, CablePorts, Dual, Effect, EffectParameter, Scope};

/// See the module documentation.
#[derive(Debug)]
pub struct EncoderDrift;

impl Effect for EncoderDrift {
    fn id(&self) -> &'static str {
        "encoder_drift"
    }
    fn title(&self) -> &'static str {
        "Encoder drift"
    }
    fn scope(&self) -> Scope {
        Scope::Cable
    }
    fn parameters(&self) -> &'static [EffectParameter] {
        const { &[EffectParameter::new("rate", "m/h", 0.01, [0.001, 0.01])] }
    }
    fn change_cable(&self, parameters: &[Dual], at: &CableCircumstances, ports: &mut CablePorts) {
        ports.paid += parameters[0] * (at.time_s / 3600.0);
    }
}

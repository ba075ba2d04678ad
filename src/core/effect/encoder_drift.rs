//! A length reading that drifts: `paid += rate t / 3600`, with the time `t` since home in seconds and the
//! rate in metres per hour. Assumes a constant rate. Typical 1 to 10 mm/h: slip that adds up, or a
//! reference that wanders.

use super::words::{self, size};
use super::{CableCircumstances, CablePorts, Dual, Effect, EffectParameter, Found, Part, Scope};

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
    fn cause(&self, found: &Found<'_>) -> String {
        format!(
            "The length {} of {} {}: the {} {} than the {}, by {} mm/h.",
            found.either("reading", "readings"),
            found.name(Part::Cable),
            found.either("drifts", "drift"),
            found.either("cable gets", "cables get"),
            found.way(0, "longer", "shorter"),
            found.either("reading says", "readings say"),
            size(1e3 * found.value(0)),
        )
    }
    fn workshop(&self, found: &Found<'_>) -> String {
        format!(
            "Check coupling and set screws between motor, encoder and drum of {}. Mark the {} on the drum to see whether it slips.",
            found.name(Part::Winch),
            found.either("cable", "cables"),
        )
    }
    fn check(&self) -> Option<&'static str> {
        Some(words::GO_BACK)
    }
    fn source(&self) -> &'static str {
        "Constant rate, first order in time"
    }
    fn change_cable(&self, parameters: &[Dual], at: &CableCircumstances, ports: &mut CablePorts) {
        ports.paid += parameters[0] * (at.time_s / 3600.0);
    }
}

//! Strain that grows with the logarithm of time: `strain += c ln(1 + t / 600 s)`, `t` since home. Assumes that
//! the load is about constant. Typical 1e-4 to 1e-2: logarithmic creep of fibre ropes.

use super::words::{self, millimetres, sentence};
use super::{CableCircumstances, CablePorts, Dual, Effect, EffectParameter, Found, Part, Scope};

/// See the module documentation.
#[derive(Debug)]
pub struct CableCreep;

impl Effect for CableCreep {
    fn id(&self) -> &'static str {
        "cable_creep"
    }
    fn title(&self) -> &'static str {
        "Cable creep"
    }
    fn scope(&self) -> Scope {
        Scope::CableOrAll
    }
    fn parameters(&self) -> &'static [EffectParameter] {
        const { &[EffectParameter::new("c", "1", 0.01, [0.0001, 0.01])] }
    }
    fn cause(&self, found: &Found<'_>) -> String {
        // The logarithm of 1 + 3600 s / 600 s.
        let first_hour = found.value(0) * 7_f64.ln();
        sentence(&format!(
            "{} {} under load: in the first hour each metre gets {} {}.",
            found.name(Part::Cable),
            found.either(
                found.way(0, "creeps", "shrinks"),
                found.way(0, "creep", "shrink"),
            ),
            millimetres(first_hour),
            found.way(0, "longer", "shorter"),
        ))
    }
    fn workshop(&self, found: &Found<'_>) -> String {
        format!(
            "Leave {} under working tension for some hours before measuring{}.",
            found.name(Part::Cable),
            if found.counts_revolutions() {
                ", and zero the encoders at home afterwards"
            } else {
                ""
            },
        )
    }
    fn check(&self) -> Option<&'static str> {
        Some(words::GO_BACK)
    }
    fn source(&self) -> &'static str {
        "Logarithmic creep of fibre ropes"
    }
    fn change_cable(&self, parameters: &[Dual], at: &CableCircumstances, ports: &mut CablePorts) {
        ports.strain += parameters[0] * (at.time_s.max(0.0) / 600.0).ln_1p();
    }
}

//! Weight per metre other than stated: `w += weight` (N/m) in the extra length by sag `w^2 h^2 l / (24 T^2)` with
//! the horizontal span `h`, free length `l` and tension `T`. Parabola, first order; needs force sensors.
//! An estimate starts at 0.1 N/m: without weight nothing depends on it to first order. Typical 0.01 to
//! 5 N/m. Source: Irvine, Cable Structures, 1981.

use super::words::sentence;
use super::{CableCircumstances, CablePorts, Dual, Effect, EffectParameter, Found, Part, Scope};

/// See the module documentation.
#[derive(Debug)]
pub struct CableSag;

impl Effect for CableSag {
    fn id(&self) -> &'static str {
        "cable_sag"
    }
    fn title(&self) -> &'static str {
        "Cable weight"
    }
    fn scope(&self) -> Scope {
        Scope::CableOrAll
    }
    fn parameters(&self) -> &'static [EffectParameter] {
        const { &[EffectParameter::new("weight", "N/m", 5.0, [0.01, 5.0]).starting_at(0.1)] }
    }
    fn cause(&self, found: &Found<'_>) -> String {
        sentence(&format!(
            "{} {} {} {} than stated and {} accordingly.",
            found.name(Part::Cable),
            found.either("weighs", "weigh"),
            found.in_its_unit(0),
            found.way(0, "more", "less"),
            found.either("sags", "sag"),
        ))
    }
    fn workshop(&self, _found: &Found<'_>) -> String {
        "Weigh a piece of the cable of known length and enter its weight per metre. Higher tensions make the sag smaller.".to_owned()
    }
    fn check(&self) -> Option<&'static str> {
        Some("Weigh a few metres of the cable.")
    }
    fn source(&self) -> &'static str {
        "Irvine, Cable Structures, 1981: parabola, first order"
    }
    fn change_cable(&self, parameters: &[Dual], _at: &CableCircumstances, ports: &mut CablePorts) {
        ports.weight += parameters[0];
    }
    fn needs_sag(&self) -> bool {
        true
    }
}

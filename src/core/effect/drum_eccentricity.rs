//! Drum out of round: `A sin(2 pi rev / gear_ratio + phase) - A sin(phase)` is added to the cable paid
//! out. Typical amplitude 0.1 to 1 mm.

use super::{
    CableCircumstances, CablePorts, Dual, Effect, EffectParameter, Found, Part, Scope, Search,
};

/// See the module documentation.
#[derive(Debug)]
pub struct DrumEccentricity;

impl Effect for DrumEccentricity {
    fn id(&self) -> &'static str {
        "drum_eccentricity"
    }
    fn title(&self) -> &'static str {
        "Drum out of round"
    }
    fn scope(&self) -> Scope {
        Scope::Cable
    }
    fn parameters(&self) -> &'static [EffectParameter] {
        const {
            &[
                EffectParameter::new("amplitude", "m", 0.001, [0.0001, 0.001]),
                EffectParameter::new(
                    "phase",
                    "rad",
                    3.0,
                    [-std::f64::consts::PI, std::f64::consts::PI],
                ),
            ]
        }
    }
    fn cause(&self, found: &Found<'_>) -> String {
        format!(
            "The {} of {} {} out of round: once per turn the cable paid out swings by {} to either side.",
            found.either("drum", "drums"),
            found.name(Part::Winch),
            found.either("is", "are"),
            found.millimetres(0),
        )
    }
    fn workshop(&self, found: &Found<'_>) -> String {
        format!(
            "Measure the runout of the {} of {} with a dial gauge; centre or replace what runs out.",
            found.either("drum", "drums"),
            found.name(Part::Winch),
        )
    }
    fn check(&self) -> Option<&'static str> {
        Some("Turn the drum once under a dial gauge.")
    }
    fn source(&self) -> &'static str {
        "Geometry of an eccentric drum; sizes from ovalisation reported for winches of cable robots"
    }
    fn search(&self) -> Search {
        Search::Wave {
            phase: 1,
            period: None,
        }
    }
    fn change_cable(&self, parameters: &[Dual], at: &CableCircumstances, ports: &mut CablePorts) {
        let [amplitude, phase] = [parameters[0], parameters[1]];
        let angle = std::f64::consts::TAU * at.revolutions * at.drum_per_motor;
        ports.paid += amplitude * ((phase + angle).sin() - phase.sin());
    }
}

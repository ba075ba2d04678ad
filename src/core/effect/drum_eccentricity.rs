//! Drum out of round: `A sin(2 pi rev / gear_ratio + phase) - A sin(phase)` is added to the cable paid
//! out. Typical amplitude 0.1 to 1 mm.

use super::{CableCircumstances, CablePorts, Dual, Effect, EffectParameter, Scope, Search};

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

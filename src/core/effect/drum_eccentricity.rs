//! Drum out of round: `A sin(2 pi rev / gear_ratio + phase) - A sin(phase)` is added to the cable paid
//! out. Typical amplitude 0.1 to 1 mm.

use super::{CableCircumstances, CablePorts, Dual, Effect, EffectParameter, Scope};

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
        &[
            EffectParameter {
                name: "amplitude",
                unit: "m",
                prior_sd: 0.001,
                typical: [0.0001, 0.001],
            },
            EffectParameter {
                name: "phase",
                unit: "rad",
                prior_sd: 3.0,
                typical: [-std::f64::consts::PI, std::f64::consts::PI],
            },
        ]
    }
    fn change_cable(&self, parameters: &[Dual], at: &CableCircumstances, ports: &mut CablePorts) {
        let [amplitude, phase] = [parameters[0], parameters[1]];
        let angle = std::f64::consts::TAU * at.revolutions * at.drum_per_motor;
        ports.paid += amplitude * ((phase + angle).sin() - phase.sin());
    }
}

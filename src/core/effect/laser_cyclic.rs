//! Cyclic error of a phase-shift laser: `A sin(2 pi d / P + phase)` is added to the reading, with amplitude `A` and
//! period `P` in metres and phase in radians.
//!
//! Approximation: `d` is the reading itself, which contains the error; second order in `2 pi A / P`, which must
//! stay below 1. A fit finds the period only if it starts within about a tenth of `P^2 / range` of it.
//! Typical amplitude 0.3 to 3 mm.

use super::{
    Dual, Effect, EffectParameter, Found, PlatformCircumstances, PlatformPorts, Scope, Search,
};

/// See the module documentation.
#[derive(Debug)]
pub struct LaserCyclic;

impl Effect for LaserCyclic {
    fn id(&self) -> &'static str {
        "laser_cyclic"
    }
    fn title(&self) -> &'static str {
        "Cyclic error of the laser"
    }
    fn scope(&self) -> Scope {
        Scope::Robot
    }
    fn parameters(&self) -> &'static [EffectParameter] {
        const {
            &[
                EffectParameter::new("amplitude", "m", 0.003, [0.0003, 0.003]),
                EffectParameter::new("period", "m", 0.5, [0.02, 0.5]).around(0.1),
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
            "The reading of the laser swings by {} to either side as the distance changes, once every {}.",
            found.millimetres(0),
            found.millimetres(1),
        )
    }
    fn workshop(&self, _found: &Found<'_>) -> String {
        "Clean the optics of the laser and use a matt target without reflections. If the error stays, have the laser checked or replace it.".to_owned()
    }
    fn check(&self) -> Option<&'static str> {
        Some("Move the target of the laser along a steel ruler in steps of a few millimetres.")
    }
    fn source(&self) -> &'static str {
        "Cyclic error of distance meters that compare phases"
    }
    fn search(&self) -> Search {
        Search::Wave {
            phase: 2,
            period: Some(1),
        }
    }
    fn change_platform(
        &self,
        parameters: &[Dual],
        at: &PlatformCircumstances,
        ports: &mut PlatformPorts,
    ) {
        let [amplitude, period, phase] = [parameters[0], parameters[1], parameters[2]];
        let turns = period.recip() * (std::f64::consts::TAU * at.laser_m);
        ports.laser_bias += amplitude * (turns + phase).sin();
    }
}

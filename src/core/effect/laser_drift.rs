//! Warm-up drift: `a (1 - exp(-t / 900 s))` is added to the laser reading, `t` since home in seconds, `a` the
//! parameter `drift` in metres. Assumes that the laser was switched on at the home row. Typical 0.5 to 5 mm.

use super::{Dual, Effect, EffectParameter, Found, PlatformCircumstances, PlatformPorts, Scope};

/// See the module documentation.
#[derive(Debug)]
pub struct LaserDrift;

impl Effect for LaserDrift {
    fn id(&self) -> &'static str {
        "laser_drift"
    }
    fn title(&self) -> &'static str {
        "Warm-up of the laser"
    }
    fn scope(&self) -> Scope {
        Scope::Robot
    }
    fn parameters(&self) -> &'static [EffectParameter] {
        const { &[EffectParameter::new("drift", "m", 0.005, [0.0005, 0.005])] }
    }
    fn cause(&self, found: &Found<'_>) -> String {
        format!(
            "The laser drifts while it warms up: in the end it reads {} {} than when it was switched on.",
            found.millimetres(0),
            found.way(0, "longer", "shorter"),
        )
    }
    fn workshop(&self, _found: &Found<'_>) -> String {
        "Switch the laser on an hour before measuring.".to_owned()
    }
    fn check(&self) -> Option<&'static str> {
        Some(
            "Switch the laser on and watch its reading for half an hour while the platform stands still.",
        )
    }
    fn source(&self) -> &'static str {
        "Exponential warm-up of first order"
    }
    fn change_platform(
        &self,
        parameters: &[Dual],
        at: &PlatformCircumstances,
        ports: &mut PlatformPorts,
    ) {
        ports.laser_bias += parameters[0] * -(-at.time_s.max(0.0) / 900.0).exp_m1();
    }
}

//! A constant in the raw reading of a force sensor: `F = g T + f0 + bias` (N), so `T = T_nominal - bias / g`. Typical
//! 2 to 50 N.

use super::words::sentence;
use super::{
    CableCircumstances, CablePorts, Dual, Effect, EffectParameter, Found, Part, Scope, Stage,
};

/// See the module documentation.
#[derive(Debug)]
pub struct ForceBias;

impl Effect for ForceBias {
    fn id(&self) -> &'static str {
        "force_bias"
    }
    fn title(&self) -> &'static str {
        "Bias of a force sensor"
    }
    fn scope(&self) -> Scope {
        Scope::Cable
    }
    fn parameters(&self) -> &'static [EffectParameter] {
        const { &[EffectParameter::new("bias", "N", 50.0, [2.0, 50.0])] }
    }
    fn cause(&self, found: &Found<'_>) -> String {
        sentence(&format!(
            "{} {} {} too {}, whatever the tension.",
            found.name(Part::ForceSensor),
            found.either("reads", "read"),
            found.in_its_unit(0),
            found.way(0, "high", "low"),
        ))
    }
    fn workshop(&self, found: &Found<'_>) -> String {
        format!(
            "Support the platform, slacken {} and zero {} again.",
            found.name(Part::Cable),
            found.name(Part::ForceSensor),
        )
    }
    fn check(&self) -> Option<&'static str> {
        Some("Slacken the cable and read its force sensor.")
    }
    fn source(&self) -> &'static str {
        "Linear sensor: Jin et al., Sensors 18 (2018) 2392, section 3.2"
    }
    fn stage(&self) -> Stage {
        Stage::Sensor
    }
    fn change_cable(&self, parameters: &[Dual], at: &CableCircumstances, ports: &mut CablePorts) {
        if at.tension_gain != 0.0 {
            ports.tension += parameters[0] * -at.tension_gain.recip();
        }
    }
}

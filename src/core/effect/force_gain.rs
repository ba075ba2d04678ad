//! Force sensor of another gain: `F = g (1 + change) T + f0`, so `T = T_nominal / (1 + change)`. Typical 2 to 20 %.

use super::words::sentence;
use super::{
    CableCircumstances, CablePorts, Dual, Effect, EffectParameter, Found, Part, Scope, Stage,
};

/// See the module documentation.
#[derive(Debug)]
pub struct ForceGain;

impl Effect for ForceGain {
    fn id(&self) -> &'static str {
        "force_gain"
    }
    fn title(&self) -> &'static str {
        "Gain of the force sensors"
    }
    fn scope(&self) -> Scope {
        Scope::CableOrAll
    }
    fn parameters(&self) -> &'static [EffectParameter] {
        const { &[EffectParameter::new("change", "1", 0.2, [0.02, 0.2])] }
    }
    fn cause(&self, found: &Found<'_>) -> String {
        sentence(&format!(
            "{} {} {} too {}.",
            found.name(Part::ForceSensor),
            found.either("reads", "read"),
            found.percent(0),
            found.way(0, "high", "low"),
        ))
    }
    fn workshop(&self, found: &Found<'_>) -> String {
        format!(
            "Hang known weights on {} and calibrate the gain of {} again.",
            found.name(Part::Cable),
            found.name(Part::ForceSensor),
        )
    }
    fn check(&self) -> Option<&'static str> {
        Some("Hang a known weight at the cable and read its force sensor.")
    }
    fn source(&self) -> &'static str {
        "Linear sensor: Jin et al., Sensors 18 (2018) 2392, section 3.2"
    }
    fn stage(&self) -> Stage {
        Stage::Ratio
    }
    fn change_cable(&self, parameters: &[Dual], _at: &CableCircumstances, ports: &mut CablePorts) {
        ports.tension *= (parameters[0] + 1.0).recip();
    }
}

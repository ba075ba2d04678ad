//! Platform of another mass: `m (1 + change)`, payload included. Seen through static equilibrium only: needs force
//! sensors on all cables. Typical 5 to 30 %.

use super::words::size;
use super::{Dual, Effect, EffectParameter, Found, PlatformCircumstances, PlatformPorts, Scope};

/// See the module documentation.
#[derive(Debug)]
pub struct PayloadMass;

impl Effect for PayloadMass {
    fn id(&self) -> &'static str {
        "payload_mass"
    }
    fn title(&self) -> &'static str {
        "Mass of the platform"
    }
    fn scope(&self) -> Scope {
        Scope::Robot
    }
    fn parameters(&self) -> &'static [EffectParameter] {
        const { &[EffectParameter::new("change", "1", 0.3, [0.05, 0.3])] }
    }
    fn cause(&self, found: &Found<'_>) -> String {
        let stated_kg = found.robot().platform.mass_kg;
        let masses = stated_kg.map(|mass_kg| {
            let [is, stated] = [mass_kg * (1.0 + found.value(0)), mass_kg].map(size);
            format!(": {is} kg instead of {stated} kg")
        });
        format!(
            "The platform is {} {} than stated{}.",
            found.percent(0),
            found.way(0, "heavier", "lighter"),
            masses.unwrap_or_default(),
        )
    }
    fn workshop(&self, _found: &Found<'_>) -> String {
        "Weigh the platform with everything that it carries, and enter that mass.".to_owned()
    }
    fn check(&self) -> Option<&'static str> {
        Some("Weigh the platform on a scale, with everything that it carries.")
    }
    fn source(&self) -> &'static str {
        "Static equilibrium"
    }
    fn change_platform(
        &self,
        parameters: &[Dual],
        _at: &PlatformCircumstances,
        ports: &mut PlatformPorts,
    ) {
        ports.mass *= parameters[0] + 1.0;
    }
}

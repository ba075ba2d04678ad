//! A constant added to every laser reading. Typical 0.5 to 5 mm; not separable from the offset of the
//! target plane.

use super::{Dual, Effect, EffectParameter, Found, PlatformCircumstances, PlatformPorts, Scope};

/// See the module documentation.
#[derive(Debug)]
pub struct LaserBias;

impl Effect for LaserBias {
    fn id(&self) -> &'static str {
        "laser_bias"
    }
    fn title(&self) -> &'static str {
        "Laser bias"
    }
    fn scope(&self) -> Scope {
        Scope::Robot
    }
    fn parameters(&self) -> &'static [EffectParameter] {
        const { &[EffectParameter::new("bias", "m", 0.005, [0.0005, 0.005])] }
    }
    fn cause(&self, found: &Found<'_>) -> String {
        format!(
            "The laser reads {} too {} at every pose.",
            found.millimetres(0),
            found.way(0, "long", "short"),
        )
    }
    fn workshop(&self, _found: &Found<'_>) -> String {
        "Check where the laser sits on the platform, and where the target is: a displaced target looks the same.".to_owned()
    }
    fn check(&self) -> Option<&'static str> {
        Some("Measure one distance from the laser to its target with a steel tape.")
    }
    fn source(&self) -> &'static str {
        "Zero error of distance meters"
    }
    fn change_platform(
        &self,
        parameters: &[Dual],
        _at: &PlatformCircumstances,
        ports: &mut PlatformPorts,
    ) {
        ports.laser_bias += parameters[0];
    }
}

//! Laser reading times `1 + scale`. Typical 0.05 to 1 %.

use super::{Dual, Effect, EffectParameter, Found, PlatformCircumstances, PlatformPorts, Scope};

/// See the module documentation.
#[derive(Debug)]
pub struct LaserScale;

impl Effect for LaserScale {
    fn id(&self) -> &'static str {
        "laser_scale"
    }
    fn title(&self) -> &'static str {
        "Laser scale"
    }
    fn scope(&self) -> Scope {
        Scope::Robot
    }
    fn parameters(&self) -> &'static [EffectParameter] {
        const { &[EffectParameter::new("scale", "1", 0.01, [0.0005, 0.01])] }
    }
    fn cause(&self, found: &Found<'_>) -> String {
        format!(
            "The laser reads distances {} too {}.",
            found.percent(0),
            found.way(0, "long", "short"),
        )
    }
    fn workshop(&self, _found: &Found<'_>) -> String {
        "Compare the laser with a tape measure at two distances far apart, and correct its scale."
            .to_owned()
    }
    fn check(&self) -> Option<&'static str> {
        Some("Measure one distance from the laser to its target with a steel tape.")
    }
    fn source(&self) -> &'static str {
        "Scale error of distance meters"
    }
    fn change_platform(
        &self,
        parameters: &[Dual],
        _at: &PlatformCircumstances,
        ports: &mut PlatformPorts,
    ) {
        ports.laser_gain *= parameters[0] + 1.0;
    }
}

//! Attachment point of a cable elsewhere on the platform: `b += (x, y, z)`, platform frame, metres. Typical 1 to
//! 10 mm.

use super::words::displacement;
use super::{CableCircumstances, CablePorts, Dual, Effect, EffectParameter, Found, Part, Scope};

/// See the module documentation.
#[derive(Debug)]
pub struct PlatformAnchor;

impl Effect for PlatformAnchor {
    fn id(&self) -> &'static str {
        "platform_anchor"
    }
    fn title(&self) -> &'static str {
        "Attachment point on the platform"
    }
    fn scope(&self) -> Scope {
        Scope::Cable
    }
    fn parameters(&self) -> &'static [EffectParameter] {
        const {
            &[
                EffectParameter::new("x", "m", 0.01, [0.001, 0.01]),
                EffectParameter::new("y", "m", 0.01, [0.001, 0.01]),
                EffectParameter::new("z", "m", 0.01, [0.001, 0.01]),
            ]
        }
    }
    fn cause(&self, found: &Found<'_>) -> String {
        let offset_m = [0, 1, 2].map(|k| found.value(k));
        format!(
            "The attachment {} of {} on the platform {} off by {} (platform axes).",
            found.either("point", "points"),
            found.name(Part::Cable),
            found.either("is", "are"),
            displacement(&offset_m),
        )
    }
    fn workshop(&self, found: &Found<'_>) -> String {
        format!(
            "Measure on the platform where {} {} attached, and enter that point.",
            found.name(Part::Cable),
            found.either("is", "are"),
        )
    }
    fn check(&self) -> Option<&'static str> {
        Some("Measure with calipers where the cable is attached to the platform.")
    }
    fn source(&self) -> &'static str {
        "Geometry"
    }
    fn change_cable(&self, parameters: &[Dual], _at: &CableCircumstances, ports: &mut CablePorts) {
        for k in 0..3 {
            ports.anchor[k] += parameters[k];
        }
    }
}

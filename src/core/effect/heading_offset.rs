//! A constant added to the yaw reading (rad), as by a compass that counts from elsewhere. Typical 1 to 180
//! degrees.

use super::{Dual, Effect, EffectParameter, Found, PlatformCircumstances, PlatformPorts, Scope};

/// See the module documentation.
#[derive(Debug)]
pub struct HeadingOffset;

impl Effect for HeadingOffset {
    fn id(&self) -> &'static str {
        "heading_offset"
    }
    fn title(&self) -> &'static str {
        "Heading offset"
    }
    fn scope(&self) -> Scope {
        Scope::Robot
    }
    fn parameters(&self) -> &'static [EffectParameter] {
        const {
            &[EffectParameter::new(
                "offset",
                "rad",
                3.0,
                [0.017, std::f64::consts::PI],
            )]
        }
    }
    fn cause(&self, found: &Found<'_>) -> String {
        format!(
            "The yaw reading of the platform is {} too {}.",
            found.degrees(0),
            found.way(0, "large", "small"),
        )
    }
    fn workshop(&self, _found: &Found<'_>) -> String {
        "Zero the heading at the home pose again. Keep a compass away from motors and steel."
            .to_owned()
    }
    fn check(&self) -> Option<&'static str> {
        Some("Align the platform with the frame and read its heading.")
    }
    fn source(&self) -> &'static str {
        "Zero error of an attitude sensor"
    }
    fn change_platform(
        &self,
        parameters: &[Dual],
        _at: &PlatformCircumstances,
        ports: &mut PlatformPorts,
    ) {
        ports.inclination_offset[2] += parameters[0];
    }
}

//! Laser reading times `1 + scale`. Typical 0.05 to 1 %.

use super::{Dual, Effect, EffectParameter, PlatformCircumstances, PlatformPorts, Scope};

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
    fn change_platform(
        &self,
        parameters: &[Dual],
        _at: &PlatformCircumstances,
        ports: &mut PlatformPorts,
    ) {
        ports.laser_gain *= parameters[0] + 1.0;
    }
}

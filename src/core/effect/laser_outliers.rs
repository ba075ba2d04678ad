//! A laser reading that is wrong: `error` (m) is added at the pose labelled `pose`, as by a reflection elsewhere.
//! For several poses name the effect several times.

use super::{Dual, Effect, EffectParameter, PlatformCircumstances, PlatformPorts, Scope, Search};

/// See the module documentation.
#[derive(Debug)]
pub struct LaserOutliers;

impl Effect for LaserOutliers {
    fn id(&self) -> &'static str {
        "laser_outliers"
    }
    fn title(&self) -> &'static str {
        "Outlier of the laser"
    }
    fn scope(&self) -> Scope {
        Scope::Robot
    }
    fn parameters(&self) -> &'static [EffectParameter] {
        const {
            &[
                EffectParameter::given("pose", "1", [1.0, 100.0]),
                EffectParameter::new("error", "m", 0.1, [0.005, 0.1]),
            ]
        }
    }
    fn search(&self) -> Search {
        Search::AtPose(0)
    }
    fn change_platform(
        &self,
        parameters: &[Dual],
        at: &PlatformCircumstances,
        ports: &mut PlatformPorts,
    ) {
        if at.is_at(parameters[0].value) {
            ports.laser_bias += parameters[1];
        }
    }
}

//! A laser reading that is wrong: `error` (m) is added at the pose labelled `pose`, as by a reflection elsewhere.
//! For several poses name the effect several times.

use super::words;
use super::{
    Dual, Effect, EffectParameter, Found, PlatformCircumstances, PlatformPorts, Scope, Search,
};

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
    fn cause(&self, found: &Found<'_>) -> String {
        format!(
            "The laser reading at {} is {} too {}.",
            found.pose(0),
            found.millimetres(1),
            found.way(1, "long", "short"),
        )
    }
    fn workshop(&self, found: &Found<'_>) -> String {
        format!(
            "Check whether something stood in the beam at {pose} or the spot missed the target. Measure that pose again or leave its laser reading out.",
            pose = found.pose(0),
        )
    }
    fn check(&self) -> Option<&'static str> {
        Some(words::GO_THERE_AGAIN)
    }
    fn source(&self) -> &'static str {
        "A single wrong reading"
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

//! A laser reading that is wrong: `error` (m) is added at the pose labelled `pose`, as by a reflection elsewhere.
//! For several poses name the effect several times. Changes simulated readings only; an estimation looks for such
//! readings, it has nothing to fit.

use super::binding::row_of;
use super::{Effect, EffectParameter, Scope};
use crate::measurement::Measurements;
use crate::robot::Robot;

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
                EffectParameter::given("error", "m", [0.005, 0.1]),
            ]
        }
    }
    fn corrupt(
        &self,
        parameters: &[f64],
        _cables: &[usize],
        _robot: &Robot,
        data: &mut Measurements,
    ) {
        if let Some(row) = row_of(data, parameters[0])
            && let Some(reading) = data.laser_m.get_mut(row)
        {
            *reading += parameters[1];
        }
    }
}

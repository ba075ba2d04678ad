//! A length reading that is wrong: `error` (m) is added to the cable paid out, or to the length, that was read at
//! the pose labelled `pose`. Changes simulated readings only; an estimation looks for such readings, it has
//! nothing to fit.

use super::binding::row_of;
use super::{Effect, EffectParameter, Scope};
use crate::measurement::Measurements;
use crate::robot::Robot;

/// See the module documentation.
#[derive(Debug)]
pub struct EncoderOutlier;

impl Effect for EncoderOutlier {
    fn id(&self) -> &'static str {
        "encoder_outlier"
    }
    fn title(&self) -> &'static str {
        "Outlier of an encoder"
    }
    fn scope(&self) -> Scope {
        Scope::Cable
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
        cables: &[usize],
        robot: &Robot,
        data: &mut Measurements,
    ) {
        let Some(row) = row_of(data, parameters[0]) else {
            return;
        };
        for cable in cables {
            let per_unit = robot.cables[*cable].winch.cable_per_revolution_m();
            for (grid, step) in [
                (&mut data.revolutions, parameters[1] / per_unit),
                (&mut data.length_m, parameters[1]),
            ] {
                if !grid.is_empty() {
                    grid.set(row, *cable, grid.get(row, *cable) + step);
                }
            }
        }
    }
}

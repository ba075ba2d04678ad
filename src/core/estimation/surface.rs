//! Finds cables outside their measured elongation, which is not to be extrapolated.

use super::evaluator::Evaluator;
use super::globals::Globals;
use super::problem::Problem;
use super::solution::OutsideSurface;
use crate::effect::CablePort;
use crate::geometry::Pose;

/// Cables outside the range of their elongation surface at the given poses.
pub(super) fn outside_surface(
    problem: &Problem<'_>,
    globals: &Globals,
    poses: &[(usize, Pose)],
) -> Vec<OutsideSurface> {
    let cables = &problem.dataset.robot.cables;
    if cables.iter().all(|c| c.cable.elongation_surface.is_none()) {
        return Vec::new();
    }
    let home = problem.home_row();
    let mut found = Vec::new();
    for (row, pose) in poses {
        let evaluator = if Some(*row) == home {
            Evaluator::<f64>::home((), problem, globals, *row)
        } else {
            Evaluator::<f64>::new((), problem, globals, vec![*row], &[*pose])
        };
        for (cable, description) in cables.iter().enumerate() {
            let Some((surface, span)) = evaluator.span_on_surface(cable) else {
                continue;
            };
            let tension = evaluator.cable_port(0, cable, CablePort::Tension);
            let measured = evaluator.cable_port(0, cable, CablePort::Paid).is_finite();
            if description.force_sensor.is_none() || tension.is_nan() || !measured {
                continue;
            }
            if let Err(range) = surface.evaluate(span, tension) {
                found.push(OutsideSurface {
                    row: *row,
                    cable,
                    range,
                });
            }
        }
    }
    found
}

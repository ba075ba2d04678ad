//! The robot that a solution describes.

use tautline_core::estimation::{ParameterId, Solution};
use tautline_core::robot::{PerAxis, Robot};

/// Standard deviation of a coordinate of an entry point (m): 0 if it was given, `None` if the data do
/// not determine it.
pub fn entry_point_sd(solution: &Solution, cable: usize, axis: usize) -> Option<f64> {
    let id = ParameterId::EntryPoint { cable, axis };
    match solution.parameters.iter().position(|p| p.id == id) {
        Some(index) => solution.standard_deviation(index),
        None => Some(0.0),
    }
}

/// Returns `robot` with the values of the solution and their standard deviations.
pub fn identified(robot: &Robot, solution: &Solution) -> Robot {
    let mut model = solution.globals.model(robot);
    for (index, cable) in model.cables.iter_mut().enumerate() {
        let prior = cable.pulley.entry_point_sd_m.each();
        let sd = |axis: usize| entry_point_sd(solution, index, axis).or(prior[axis]);
        cable.pulley.entry_point_sd_m = PerAxis::Each([0, 1, 2].map(sd));
    }
    if let Some(laser) = &mut model.laser {
        let plane = |id: &ParameterId| *id == ParameterId::PlaneOffset;
        if let Some(k) = solution.parameters.iter().position(|p| plane(&p.id)) {
            let sd = solution.standard_deviation(k);
            laser.target_plane.offset_sd_m = sd.or(laser.target_plane.offset_sd_m);
        }
    }
    model
}

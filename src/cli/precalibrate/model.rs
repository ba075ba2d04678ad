//! The robot with the values of a precalibration.

use tautline_core::robot::Robot;

use super::document::Precalibration;
use tautline_workflow::precalibration::{put_force_sensor, put_home, put_surface, put_winch};

/// Puts the fitted values into the robot; returns what could not be put, one sentence each.
///
/// # Errors
/// One sentence if a winch cannot have the drum that its fit asks for.
pub fn apply(fitted: &Precalibration, robot: &mut Robot) -> Result<Vec<String>, String> {
    let mut left_out = Vec::new();
    for result in &fitted.winches {
        let Some(cable) = robot.cables.iter_mut().find(|c| c.name == result.cable) else {
            continue;
        };
        put_winch(&mut cable.winch, result.cable_per_revolution_m)
            .map_err(|message| format!("winch.csv: {}: {message}", result.cable))?;
    }
    for result in &fitted.force_sensors {
        if let Some(cable) = robot.cables.iter_mut().find(|c| c.name == result.cable) {
            left_out.extend(put_force_sensor(cable, result.tension_gain, result.bias_n).err());
        }
    }
    if let Some(home) = &fitted.home {
        let position = (home.position_m, home.position_sd_m);
        let orientation = (home.orientation_wxyz, home.orientation_sd_rad);
        left_out.extend(put_home(robot, position, orientation).err());
    }
    if let Some(elongation) = &fitted.elongation {
        put_surface(robot, &elongation.surface);
    }
    Ok(left_out)
}

//! The robot with the values of a precalibration.

use tautline_core::robot::{Robot, Winch};

use super::document::{HomeResult, Precalibration};

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
        set_cable_per_revolution(&mut cable.winch, result.cable_per_revolution_m)
            .map_err(|message| format!("winch.csv: {}: {message}", result.cable))?;
    }
    for result in &fitted.force_sensors {
        let cable = robot.cables.iter_mut().find(|c| c.name == result.cable);
        match cable.and_then(|cable| cable.force_sensor.as_mut()) {
            Some(sensor) => {
                sensor.tension_gain = result.tension_gain;
                sensor.bias_n = result.bias_n;
            }
            None => left_out.push(format!(
                "{} has no force_sensor in robot.json: its gain and bias are not in the model",
                result.cable
            )),
        }
    }
    if let Some(home) = &fitted.home {
        left_out.extend(set_home(home, robot));
    }
    if let Some(elongation) = &fitted.elongation {
        for cable in &mut robot.cables {
            cable.cable.elongation_surface = Some(elongation.surface.clone());
        }
    }
    Ok(left_out)
}

/// Chooses the drum's diameter; pitch and gear ratio stay.
fn set_cable_per_revolution(winch: &mut Winch, metres: f64) -> Result<(), String> {
    let (per_turn, pitch) = (metres * winch.gear_ratio, winch.drum_pitch_m);
    if per_turn <= pitch {
        return Err(format!(
            "found {per_turn} m of cable per turn of the drum, expected more than its pitch of {pitch} m"
        ));
    }
    // (a - b)(a + b) loses less to rounding than a^2 - b^2.
    let round = ((per_turn - pitch) * (per_turn + pitch)).sqrt();
    winch.drum_diameter_m = round / std::f64::consts::PI;
    Ok(())
}

/// The standard deviation of all coordinates is that of the worst.
fn set_home(result: &HomeResult, robot: &mut Robot) -> Option<String> {
    let largest = |values: [f64; 3]| values.into_iter().fold(0.0, f64::max);
    let Some(home) = &mut robot.home else {
        return Some("robot.json has no home: the home pose is not in the model".to_owned());
    };
    home.position_m = result.position_m;
    home.orientation_wxyz = result.orientation_wxyz;
    home.position_sd_m = largest(result.position_sd_m);
    home.orientation_sd_rad = largest(result.orientation_sd_rad);
    None
}

//! Applies the values of phases 1 and 2 to a robot.

use std::f64::consts::PI;

use tautline_core::cable::ElongationSurface;
use tautline_core::instrument::HomeAverage;
use tautline_core::robot::{Cable, Home, Robot, Winch};

/// Sets the drum diameter so that one motor revolution pays out `metres`; pitch and gear ratio stay.
///
/// # Errors
/// One sentence, if no drum with this pitch does so.
pub fn set_cable_per_revolution(winch: &mut Winch, metres: f64) -> Result<(), String> {
    let (per_turn, pitch) = (metres * winch.gear_ratio, winch.drum_pitch_m);
    if per_turn <= pitch {
        return Err(format!(
            "found {per_turn} m of cable per turn of the drum, expected more than its pitch of {pitch} m"
        ));
    }
    // (a - b)(a + b) loses less to rounding than a^2 - b^2.
    let round = ((per_turn - pitch) * (per_turn + pitch)).sqrt();
    winch.drum_diameter_m = round / PI;
    Ok(())
}

/// Sets gain and bias (N) of a cable's force sensor.
///
/// # Errors
/// One sentence, if the cable has no force sensor.
pub fn set_force_sensor(cable: &mut Cable, gain: f64, bias_n: f64) -> Result<(), String> {
    let Some(sensor) = &mut cable.force_sensor else {
        return Err(format!(
            "{} has no force_sensor in robot.json: its gain and bias are not in the model",
            cable.name
        ));
    };
    sensor.tension_gain = gain;
    sensor.bias_n = bias_n;
    Ok(())
}

/// Sets the home pose and its covariance; the standard deviation of all coordinates (m, rad) is that of the worst one.
pub fn set_home(robot: &mut Robot, measured: &HomeAverage) {
    let largest = |values: [f64; 3]| values.into_iter().fold(0.0, f64::max);
    let (position_sd_m, orientation_sd_rad) = measured.sd();
    robot.home = Some(Home {
        position_m: measured.pose.position.into(),
        orientation_wxyz: measured.pose.orientation_wxyz(),
        position_sd_m: largest(position_sd_m),
        orientation_sd_rad: largest(orientation_sd_rad),
        covariance: Some(
            [0, 1, 2, 3, 4, 5].map(|i| [0, 1, 2, 3, 4, 5].map(|k| measured.covariance[(i, k)])),
        ),
    });
}

/// Gives all cables the measured elongation.
pub fn set_elongation_surface(robot: &mut Robot, surface: &ElongationSurface) {
    for cable in &mut robot.cables {
        cable.cable.elongation_surface = Some(surface.clone());
    }
}

//! Rounds numbers as instruments and people write them: files are short, and the same on machines that round differently in
//! the last digits.

use serde_json::{Number, Value};
use tautline_core::geometry::Pose;
use tautline_core::measurement::{Grid, Measurements, Truth};
use tautline_core::robot::Robot;
use tautline_session::PhaseData;

/// Significant digits of a computed result, and of a deviation.
const DIGITS: usize = 6;
/// Steps per unit of true and commanded values (m, or components of a quaternion).
const EXACT: f64 = 1e9;
/// Steps of an encoder per revolution.
const REVOLUTION: f64 = 1e5;
/// Steps of a distance per metre.
const METRE: f64 = 1e5;
/// Steps of a force per newton.
const NEWTON: f64 = 1e2;

/// Rounds to a whole number of steps, `steps` per unit. The division gives the number with the fewest digits.
fn to(steps: f64, value: f64) -> f64 {
    // The sum turns -0 into 0.
    (value * steps).round() / steps + 0.0
}

fn grid(steps: f64, values: &Grid) -> Grid {
    let mut rounded = Grid::new(values.columns());
    for row in 0..values.rows() {
        let row: Vec<f64> = values.row(row).iter().map(|v| to(steps, *v)).collect();
        rounded.push_row(&row);
    }
    rounded
}

fn pose(pose: &Pose) -> Pose {
    let position: [f64; 3] = pose.position.into();
    let orientation = pose.orientation_wxyz().map(|v| to(EXACT, v));
    Pose::from_parts(position.map(|v| to(EXACT, v)), orientation)
}

/// Readings as the instruments give them, without the true values of the simulation.
pub fn readings(measurements: &Measurements) -> Measurements {
    let commanded = measurements.commanded.iter();
    Measurements {
        commanded: commanded.map(|given| given.as_ref().map(pose)).collect(),
        temperature_c: (measurements.temperature_c.iter())
            .map(|v| to(NEWTON, *v))
            .collect(),
        revolutions: grid(REVOLUTION, &measurements.revolutions),
        force_n: grid(NEWTON, &measurements.force_n),
        laser_m: measurements.laser_m.iter().map(|v| to(METRE, *v)).collect(),
        tracked_position_m: (measurements.tracked_position_m.iter())
            .map(|at| at.map(|v| to(METRE, v)))
            .collect(),
        tracked_orientation_wxyz: (measurements.tracked_orientation_wxyz.iter())
            .map(|q| q.map(|v| to(EXACT, v)))
            .collect(),
        truth: Truth::default(),
        ..measurements.clone()
    }
}

/// Tables of the bench as written by hand.
pub fn tables(mut phases: PhaseData) -> PhaseData {
    for pair in &mut phases.winch {
        pair.length_m = to(METRE, pair.length_m);
    }
    for pair in &mut phases.force {
        pair.reading_n = to(NEWTON, pair.reading_n);
    }
    for reading in &mut phases.home {
        reading.reading = to(METRE, reading.reading);
    }
    for point in &mut phases.elongation {
        // Elongations are fractions of a millimetre.
        point.elongation_m = to(METRE * 10.0, point.elongation_m);
    }
    phases
}

/// The true robot: its geometry to a nanometre, deviations of its parts to six significant digits.
pub fn truth(robot: &Robot) -> Robot {
    let mut rounded = robot.clone();
    let exact = |values: [f64; 3]| values.map(|v| to(EXACT, v));
    for cable in &mut rounded.cables {
        cable.pulley.entry_point_m = exact(cable.pulley.entry_point_m);
    }
    if let Some(home) = &mut rounded.home {
        let at = pose(&home.pose());
        home.position_m = at.position.into();
        home.orientation_wxyz = at.orientation_wxyz();
    }
    if let Some(laser) = &mut rounded.laser {
        laser.target_plane.offset_m = to(EXACT, laser.target_plane.offset_m);
    }
    for deviation in &mut rounded.deviations {
        for value in deviation.parameters.values_mut() {
            *value = significant(*value).unwrap_or(*value);
        }
    }
    rounded
}

/// Rounds a number to six significant digits.
fn significant(value: f64) -> Option<f64> {
    format!("{value:.*e}", DIGITS - 1).parse().ok()
}

/// Rounds the numbers of a computed document to six significant digits.
pub fn result(value: &mut Value) {
    match value {
        Value::Array(values) => values.iter_mut().for_each(result),
        Value::Object(fields) => fields.values_mut().for_each(result),
        Value::Number(number) if number.is_f64() => {
            let rounded = number.as_f64().and_then(significant);
            if let Some(rounded) = rounded.and_then(Number::from_f64) {
                *number = rounded;
            }
        }
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn results_keep_six_digits_and_their_integers() {
        let mut value = json!({"version": 1, "a": [0.123456789, -1.5, 12345678.0], "b": null});
        result(&mut value);
        assert_eq!(
            value,
            json!({"version": 1, "a": [0.123457, -1.5, 12345700.0], "b": null})
        );
        assert!(to(METRE, -1e-9).is_sign_positive());
    }
}

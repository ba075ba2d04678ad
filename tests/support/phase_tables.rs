//! Tables of phases 1 and 2 with known values.

use std::fmt::Write;

use serde_json::{Value, json};

/// Cable per revolution of a winch (m); the robot of the drawing has 0.12568 m.
#[must_use]
pub fn per_revolution(cable: usize) -> f64 {
    0.125 + 1e-4 * cable as f64
}

/// Pairs whose residuals sum to zero and are orthogonal to the revolutions, so that the largest residual is
/// their amplitude: 0.02 mm, and 0.3 mm for `failing`.
#[must_use]
pub fn winch_table(failing: Option<usize>) -> String {
    let mut text = "cable,rev,length_m\n".to_owned();
    for cable in 1..=8 {
        let amplitude = if failing == Some(cable) { 3e-4 } else { 2e-5 };
        for (rev, sign) in [(-3.0, 1.0), (-1.0, -1.0), (1.0, -1.0), (3.0, 1.0)] {
            let length = per_revolution(cable) * rev + 0.5 + amplitude * sign;
            let _ = writeln!(text, "cable-{cable},{rev},{length}");
        }
    }
    text
}

/// Gain 2.02 and bias 1.5 N on two cables, readings 0.2 N off.
#[must_use]
pub fn force_table() -> String {
    let mut text = "cable,reading_n,load_n\n".to_owned();
    for (load, sign) in [(10.0, 1.0), (30.0, -1.0), (50.0, -1.0), (70.0, 1.0)] {
        let reading = 2.02 * load + 1.5 + 0.2 * sign;
        let _ = writeln!(text, "1,{reading},{load}\ncable-2,{reading},{load}");
    }
    text
}

/// Three sensors look up, two and one sideways; the reference lies 0.3 m below the base frame.
#[must_use]
pub fn home_platform() -> Value {
    let sensor = |origin: [f64; 3], direction: [f64; 3], plane: usize| json!({"origin_m": origin, "direction": direction, "plane": plane, "sd_m": 2e-4});
    let (up, x, y) = ([0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
    json!({
        "base_from_reference": {"position_m": [0, 0, -0.3], "orientation_wxyz": [1, 0, 0, 0]},
        "sensors": [
            sensor([0.05, 0.04, 0.05], up, 0), sensor([-0.05, 0.04, 0.05], up, 0),
            sensor([0.0, -0.06, 0.05], up, 0), sensor([-0.2, 0.05, 0.3], x, 1),
            sensor([-0.2, -0.05, 0.3], x, 1), sensor([0.01, -0.2, 0.3], y, 2)],
        "planes": [
            {"normal": [0, 0, -1], "offset_m": 0.06}, {"normal": [-1, 0, 0], "offset_m": 0.07},
            {"normal": [0, -1, 0], "offset_m": 0.08}]})
}

/// The platform stands at (1, 2, 3) mm in the base frame; in two repeats it is 0.1 mm above and below.
#[must_use]
pub fn home_table() -> String {
    let mut text = "sensor,reading\n".to_owned();
    for up in [1e-4, -1e-4] {
        let bottom = 0.003 + 0.3 - 0.06 - 0.05 + up;
        let sides = [0.001 - 0.07 + 0.2, 0.002 - 0.08 + 0.2];
        let distances = [bottom, bottom, bottom, sides[0], sides[0], sides[1]];
        for (k, distance) in distances.iter().enumerate() {
            let _ = writeln!(text, "{},{distance}", k + 1);
        }
    }
    text
}

/// `length tension / 4e4 N`, so of degree 2; errors of 5 micrometres without a pattern.
#[must_use]
pub fn elongation_table() -> String {
    let mut text = "length_m,tension_n,elongation_m\n".to_owned();
    let mut state = 1_u32;
    for step in 0..8 {
        for tension in (10..=80).step_by(10) {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let error = 1e-5 * (f64::from(state) / f64::from(u32::MAX) - 0.5);
            let length = 1.0 + 0.25 * f64::from(step);
            let elongation = length * f64::from(tension) / 4e4 + error;
            let _ = writeln!(text, "{length},{tension},{elongation}");
        }
    }
    text
}

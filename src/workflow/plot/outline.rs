//! A robot as a few lines: a small picture by which robots in a list can be told apart.

use tautline_core::geometry::Vec3;
use tautline_core::robot::Robot;

/// Width and height of the square in which the lines lie.
pub const OUTLINE_SIZE: i16 = 1000;

/// The straight line of each cable from its pulley to the platform at the home pose, in the order of the cables: x and y of both ends, y
/// downwards. A spatial robot is seen along a diagonal, a planar one from its side.
#[must_use]
pub fn outline(robot: &Robot) -> Vec<[i16; 4]> {
    let Some(home) = robot.home.map(|home| home.pose()) else {
        return Vec::new();
    };
    let is_planar = robot
        .cables
        .iter()
        .all(|c| c.pulley.entry_point_m[2].abs() < 1e-9);
    let seen = |at: Vec3| match is_planar {
        true => [at.x, -at.y],
        false => [0.87 * (at.x - at.y), 0.4 * (at.x + at.y) - at.z],
    };
    let lines: Vec<[[f64; 2]; 2]> = robot
        .cables
        .iter()
        .map(|cable| {
            let anchor = home.transform(&Vec3::from(cable.platform_anchor_m));
            [Vec3::from(cable.pulley.entry_point_m), anchor].map(seen)
        })
        .collect();
    let range = |axis: usize| {
        let all = || lines.iter().flatten().map(|end| end[axis]);
        (
            all().fold(f64::INFINITY, f64::min),
            all().fold(f64::NEG_INFINITY, f64::max),
        )
    };
    let ranges = [0, 1].map(range);
    let size = ranges
        .iter()
        .map(|(least, most)| most - least)
        .fold(0.0, f64::max);
    let place = |end: [f64; 2], axis: usize| {
        let (least, most) = ranges[axis];
        (f64::from(OUTLINE_SIZE) * (0.5 + (end[axis] - 0.5 * (least + most)) / size)) as i16
    };
    let line = |[a, b]: &[[f64; 2]; 2]| [place(*a, 0), place(*a, 1), place(*b, 0), place(*b, 1)];
    lines.iter().map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use tautline_core::robot::presets;

    #[test]
    fn every_cable_is_a_line_in_the_square() {
        for name in ["mini", "planar"] {
            let robot = presets::find(name).expect("a preset").robot;
            let lines = outline(&robot);
            assert_eq!(lines.len(), robot.cable_count());
            let values = || lines.iter().flatten();
            assert!(values().all(|value| (0..=OUTLINE_SIZE).contains(value)));
            assert!(values().any(|value| *value == OUTLINE_SIZE));
        }
    }
}

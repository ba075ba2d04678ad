//! The robots of the test: the presets, and variants of them with other sensors.

use tautline_core::robot::presets::{self, Preset};
use tautline_core::robot::{Inclinometer, PerAxis, Robot, Tracker};

/// A robot with a name of its own.
#[derive(Debug, Clone)]
pub struct TestRobot {
    /// Name in tables and commands.
    pub name: &'static str,
    /// The robot, where it moves and how its cables are tensioned.
    pub preset: Preset,
}

/// Name, preset it comes from, and what is changed of it.
type Variant = (&'static str, &'static str, fn(&mut Robot));

const VARIANTS: [Variant; 9] = [
    ("mini", "mini", |_| ()),
    ("hall", "hall", |_| ()),
    ("suspended", "suspended", |_| ()),
    ("planar", "planar", |_| ()),
    ("mini-forceless", "mini", without_force_sensors),
    ("mini-inclined", "mini", with_inclinometer),
    ("mini-tracked", "mini", with_tracker),
    ("mini-swivels", "mini", with_swivel_sensors),
    ("mini-absolute", "mini", without_home),
];

fn without_force_sensors(robot: &mut Robot) {
    for cable in &mut robot.cables {
        cable.force_sensor = None;
    }
}

fn with_inclinometer(robot: &mut Robot) {
    robot.inclinometer = Some(Inclinometer { sd_rad: 5e-4 });
}

fn with_tracker(robot: &mut Robot) {
    robot.tracker = Some(Tracker {
        position_sd_m: PerAxis::Same(2e-4),
        orientation_sd_rad: Some(1e-3),
    });
}

fn with_swivel_sensors(robot: &mut Robot) {
    for cable in &mut robot.cables {
        cable.pulley.swivel_zero = Some([1.0, 0.0, 0.0]);
        cable.pulley.swivel_sd_rad = Some(2e-3);
    }
}

/// Lengths are read absolutely: nothing counts from a home pose.
fn without_home(robot: &mut Robot) {
    robot.home = None;
}

/// All robots of the test.
#[must_use]
pub fn robots() -> Vec<TestRobot> {
    VARIANTS.iter().filter_map(build).collect()
}

/// The robot called `name`.
#[must_use]
pub fn robot(name: &str) -> Option<TestRobot> {
    VARIANTS.iter().find(|v| v.0 == name).and_then(build)
}

fn build((name, of, change): &Variant) -> Option<TestRobot> {
    let mut preset = presets::find(of)?;
    change(&mut preset.robot);
    preset.robot.name = (*name).to_owned();
    Some(TestRobot { name, preset })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_robot_is_possible() {
        assert_eq!(robots().len(), VARIANTS.len());
        for robot in robots() {
            robot.preset.robot.check().unwrap();
        }
    }
}

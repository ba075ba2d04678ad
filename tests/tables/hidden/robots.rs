//! The robots of the study: the presets, variants with other sensors, and two robots typical of real machines.

use tautline_core::geometry::Pose;
use tautline_core::robot::presets::{self, Preset};
use tautline_core::robot::{Home, Inclinometer, PerAxis, Robot, Tracker};
use tautline_core::simulation::{TensionRange, Workspace};

use super::POSES;

/// How the true robot is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Truth {
    /// From the standard deviations of the description.
    AsStated,
    /// Entry points deviate by some centimetres, while the description gives no standard deviation.
    AnchorsUnknown,
    /// From the standard deviations, with poses at which the platform hangs at rest.
    Hanging,
}

/// A named robot of the study.
#[derive(Debug, Clone)]
pub struct TestRobot {
    /// Name in tables and commands.
    pub name: &'static str,
    /// The robot with its workspace and tensions.
    pub preset: Preset,
    /// Number of poses per dataset, without the home pose.
    pub poses: usize,
    /// How the true robot is drawn.
    pub truth: Truth,
}

/// Name, preset, and function that modifies the preset.
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

/// A planar robot with absolute lengths and unknown anchors.
const UNMEASURED: Variant = ("planar-unmeasured", "planar", of_unmeasured_anchors);
/// Number of poses of this robot.
const UNMEASURED_POSES: usize = 100;

/// A platform that hangs on four cables.
const HANGING: Variant = ("hanging", "suspended", on_four_cables);
/// Number of poses of this robot.
const HANGING_POSES: usize = 27;

/// Without force sensors the tension limits are unknown, too.
fn without_force_sensors(robot: &mut Robot) {
    for cable in &mut robot.cables {
        cable.force_sensor = None;
    }
    if let Some(limits) = &mut robot.limits {
        limits.tension = None;
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

/// With absolute length readings there is no home pose.
fn without_home(robot: &mut Robot) {
    robot.home = None;
}

fn of_unmeasured_anchors(robot: &mut Robot) {
    without_home(robot);
    without_force_sensors(robot);
    robot.laser = None;
    robot.tracker = Some(Tracker {
        position_sd_m: PerAxis::Same(5e-4),
        orientation_sd_rad: Some(1e-3),
    });
    for cable in &mut robot.cables {
        // No reading depends on the coordinate perpendicular to the plane, so it is fixed.
        cable.pulley.entry_point_sd_m = PerAxis::Each([None, None, Some(0.0)]);
        cable.winch.length_sd_m = 5e-4;
    }
}

/// Four eyelets at the corners of a hall of 6 m x 5 m x 4 m, and a plate of 0.5 m x 0.4 m with its centre of mass below
/// its anchors.
fn on_four_cables(robot: &mut Robot) {
    robot.cables.truncate(4);
    robot.laser = None;
    with_inclinometer(robot);
    with_swivel_sensors(robot);
    robot.home = Some(Home {
        position_m: [0.0, 0.0, 1.5],
        orientation_wxyz: [1.0, 0.0, 0.0, 0.0],
        position_sd_m: 1e-3,
        orientation_sd_rad: 1e-3,
        covariance: None,
    });
    robot.platform.mass_kg = Some(20.0);
    robot.platform.center_of_mass_m = [0.0, 0.0, -0.15];
    let corners = [(1.0, -1.0), (-1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)];
    for (cable, (x, y)) in robot.cables.iter_mut().zip(corners) {
        cable.pulley.entry_point_m = [3.0 * x, 2.5 * y, 4.0];
        cable.pulley.entry_point_sd_m = PerAxis::known(4e-3);
        cable.pulley.radius_m = 0.03;
        cable.platform_anchor_m = [0.25 * x, 0.2 * y, 0.1];
        cable.winch.drum_diameter_m = 0.06;
        cable.winch.drum_pitch_m = 0.003;
        cable.winch.gear_ratio = 4.0;
        cable.winch.length_to_pulley_m = 2.0;
        cable.winch.length_sd_m = 2e-4;
        cable.cable.axial_stiffness_n = Some(2e5);
        cable.cable.weight_n_per_m = 0.0;
        if let Some(sensor) = &mut cable.force_sensor {
            sensor.tension_gain = 1.0;
            sensor.tension_sd_n = 0.5;
        }
    }
}

/// The robots of all studies, without those that belong to a single study.
#[must_use]
pub fn robots() -> Vec<TestRobot> {
    VARIANTS.iter().filter_map(build).collect()
}

/// Names of all robots, including those that belong to a single study.
pub(super) fn all_names() -> impl Iterator<Item = &'static str> {
    let all = VARIANTS.iter().chain([&UNMEASURED, &HANGING]);
    all.map(|variant| variant.0)
}

/// The robot with a given name.
#[must_use]
pub fn robot(name: &str) -> Option<TestRobot> {
    if name == UNMEASURED.0 {
        return Some(TestRobot {
            poses: UNMEASURED_POSES,
            truth: Truth::AnchorsUnknown,
            ..build(&UNMEASURED)?
        });
    }
    if name == HANGING.0 {
        let robot = build(&HANGING)?;
        let home = robot.preset.robot.home.map(|home| home.pose());
        let preset = Preset {
            workspace: Workspace {
                centre: home.unwrap_or_else(Pose::identity),
                half_extent_m: [1.2, 1.0, 0.8],
                half_rotation_rad: 0.0,
            },
            tension: TensionRange {
                lower_n: 5.0,
                reference_n: 80.0,
                upper_n: 500.0,
            },
            ..robot.preset
        };
        return Some(TestRobot {
            preset,
            poses: HANGING_POSES,
            truth: Truth::Hanging,
            ..robot
        });
    }
    VARIANTS.iter().find(|v| v.0 == name).and_then(build)
}

fn build((name, of, change): &Variant) -> Option<TestRobot> {
    let mut preset = presets::find(of)?;
    change(&mut preset.robot);
    preset.robot.name = (*name).to_owned();
    Some(TestRobot {
        name,
        preset,
        poses: POSES,
        truth: Truth::AsStated,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_robot_is_possible() {
        assert_eq!(robots().len(), VARIANTS.len());
        for name in all_names() {
            robot(name).unwrap().preset.robot.check().unwrap();
        }
    }
}

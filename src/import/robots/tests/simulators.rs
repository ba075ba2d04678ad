//! URDF, SDF and the yaml of cdpr.

use tautline_core::geometry::Coordinate;
use tautline_core::robot::presets;

use super::{read, rounded};
use crate::{Dialect, Meaning};

const ARM: &str = r#"<?xml version="1.0"?>
<!-- comments stay -->
<robot name="two">
  <link name="world"/>
  <link name="frame"/>
  <joint name="ground" type="fixed">
    <origin xyz="0 0 1" rpy="0 0 1.5707963267948966"/><parent link="world"/><child link="frame"/>
  </joint>
  <link name="pulley_left"/>
  <joint name="a" type="fixed"><origin xyz="2 0 0"/><parent link="frame"/><child link="pulley_left"/></joint>
  <link name="pulley_2"/>
  <joint name="b" type="fixed"><origin xyz="-2 0 0"/><parent link="frame"/><child link="pulley_2"/></joint>
  <link name="box">
    <inertial><origin xyz="0 0 0.1"/><mass value="3"/>
      <inertia ixx="1" ixy="0.1" ixz="0.2" iyy="2" iyz="0.3" izz="2.5"/></inertial>
  </link>
  <joint name="moves" type="floating">
    <origin xyz="0.5 0 -0.5"/><parent link="frame"/><child link="box"/>
  </joint>
  <link name="anchor_left"/>
  <joint name="c" type="fixed"><origin xyz="0.1 0 0.05"/><parent link="box"/><child link="anchor_left"/></joint>
  <link name="anchor_2"/>
  <joint name="d" type="fixed"><origin xyz="-0.1 0 0.05"/><parent link="box"/><child link="anchor_2"/></joint>
</robot>
"#;

/// A world with a model whose frames are relative to each other, one of them to a turned link.
const WORLD: &str = r#"<?xml version="1.0"?>
<sdf version="1.9"><world name="hall">
  <model name="ground"><link name="plane"/></model>
  <model name="two">
    <link name="mast"><pose>0 0 1 0 0 1.5707963267948966</pose></link>
    <link name="box">
      <pose><!-- home -->0.5 0 1 0 0 1.5707963267948966</pose>
      <inertial>
        <pose>0 0 0.1 0 0 0</pose><mass>4</mass>
        <inertia><ixx>1</ixx><iyy>2</iyy><izz>3</izz><ixy>0.1</ixy></inertia>
      </inertial>
    </link>
    <frame name="pulley_1" attached_to="mast"><pose>2 0 3 1 2 3</pose></frame>
    <frame name="pulley_2"><pose relative_to="__model__">-2 0 3 0 0 0</pose></frame>
    <frame name="anchor_1" attached_to="box"><pose>0.1 0 0.2 0 0 0</pose></frame>
    <frame name="anchor_2" attached_to="box"><pose relative_to="pulley_2">2.5 -0.1 -1.8 0 0 0</pose></frame>
  </model>
</world></sdf>
"#;

const YAML: &str = "# mine\nframe: {color: Grey, radius: 0.02}\nplatform:\n  mass: 2.5\n  inertia: [1, 2, 2.5, 0.1, 0.2, 0.3]\n  position:\n    rpy: [0, 0, 1.5707963267948966]\n    xyz: [0, 0.5, 0.2]\npoints:\n- frame: [-2.0, 0.0, 3.5] # left\n  platform: [0.6, -0.3, -0.2]\n- platform:\n  - -0.6\n  - 0.3\n  - 0.2\n  frame:\n  - 2\n  - 0.1\n  - 3.5\nsim_cables: true\n";

/// One text of each dialect.
pub(super) const ALL: [&str; 3] = [ARM, WORLD, YAML];

fn close(found: [f64; 3], expected: [f64; 3]) {
    for (found, expected) in found.into_iter().zip(expected) {
        assert!((found - expected).abs() < 1e-8, "{found} {expected}");
    }
}

#[test]
fn links_of_urdf_are_cable_points_wherever_they_are_fixed() {
    let robot = read(&[("two.urdf", ARM)]).expect("a robot").value;
    let names: Vec<&str> = robot.cables.iter().map(|cable| &*cable.name).collect();
    assert_eq!(names, ["left", "cable-2"]);
    close(robot.cables[0].pulley.entry_point_m, [0.0, 2.0, 1.0]);
    close(robot.cables[1].platform_anchor_m, [-0.1, 0.0, 0.05]);
    close(robot.home.expect("a home").position_m, [0.0, 0.5, 0.5]);
    assert_eq!(robot.platform.free, Coordinate::ALL);
    assert_eq!(robot.platform.mass_kg, Some(3.0));
    let inertia = [1.0, 2.0, 2.5, 0.1, 0.2, 0.3];
    assert_eq!(robot.platform.inertia_kg_m2, Some(inertia));
    assert_eq!(robot.platform.center_of_mass_m, [0.0, 0.0, 0.1]);
}

#[test]
fn frames_of_sdf_are_cable_points_wherever_they_are_attached() {
    let robot = read(&[("two.sdf", WORLD)]).expect("a robot").value;
    assert_eq!(robot.cables.len(), 2);
    close(robot.cables[0].pulley.entry_point_m, [0.0, 2.0, 4.0]);
    close(robot.cables[1].pulley.entry_point_m, [-2.0, 0.0, 3.0]);
    close(robot.cables[0].platform_anchor_m, [0.1, 0.0, 0.2]);
    close(robot.cables[1].platform_anchor_m, [-0.1, 0.0, 0.2]);
    close(robot.home.expect("a home").position_m, [0.5, 0.0, 1.0]);
    assert_eq!(robot.platform.mass_kg, Some(4.0));
    assert_eq!(robot.platform.center_of_mass_m, [0.0, 0.0, 0.1]);
    let inertia = [1.0, 2.0, 3.0, 0.1, 0.0, 0.0];
    assert_eq!(robot.platform.inertia_kg_m2, Some(inertia));
}

#[test]
fn points_of_the_yaml_of_cdpr() {
    let robot = read(&[("two.yaml", YAML)]).expect("a robot").value;
    close(robot.cables[0].pulley.entry_point_m, [-2.0, 0.0, 3.5]);
    close(robot.cables[1].pulley.entry_point_m, [2.0, 0.1, 3.5]);
    close(robot.cables[1].platform_anchor_m, [-0.6, 0.3, 0.2]);
    let home = robot.home.expect("a home");
    close(home.position_m, [0.0, 0.5, 0.2]);
    assert!((home.orientation_wxyz[3] - 0.5_f64.sqrt()).abs() < 1e-9);
    assert_eq!(robot.platform.mass_kg, Some(2.5));
    let inertia = [1.0, 2.0, 2.5, 0.1, 0.2, 0.3];
    assert_eq!(robot.platform.inertia_kg_m2, Some(inertia));
}

#[test]
fn new_texts_of_geometry_are_read_as_the_same_robot() {
    let mut robot = presets::find("mini").expect("a preset").robot;
    robot.platform.mass_kg = Some(7.5);
    robot.platform.inertia_kg_m2 = Some([1.0, 2.0, 2.5, 0.1, 0.2, 0.3]);
    robot.home.as_mut().expect("a home").orientation_wxyz = [0.8, 0.0, 0.36, 0.48];
    for cable in &mut robot.cables {
        cable.pulley.radius_m = 0.0;
    }
    for name in ["urdf", "sdf", "cdpr"] {
        let mut all = Dialect::ALL.into_iter();
        let dialect = all.find(|one| one.name == name).expect("a dialect");
        let text = (dialect.new_text)(&robot);
        assert_eq!(Dialect::of(&text).map(|one| one.name), Some(name));
        let read = (dialect.read)("new", &text).expect("a robot");
        let again = &read.robot;
        for (old, new) in robot.cables.iter().zip(&again.cables) {
            assert_eq!(old.name, new.name);
            close(new.pulley.entry_point_m, old.pulley.entry_point_m);
            close(new.platform_anchor_m, old.platform_anchor_m);
        }
        assert_eq!(again.platform.free, robot.platform.free);
        assert_eq!(again.platform.mass_kg, robot.platform.mass_kg);
        assert_eq!(again.platform.inertia_kg_m2, robot.platform.inertia_kg_m2);
        let [old, new] = [&robot, again].map(|robot| robot.home.expect("a home").pose());
        assert!(new.difference(&old).norm() < 1e-8, "{name}");
        // Six numbers of each cable can be changed where they are.
        assert_eq!(read.parameters.len(), 48);
        let values: Vec<f64> = (0..48).map(f64::from).collect();
        let moved = (dialect.read)("new", &read.text_with(&text, &values, &rounded));
        for parameter in moved.expect("the moved robot").parameters {
            let place = values.iter().position(|value| *value == parameter.value);
            let place = place.expect("a new value");
            assert_eq!(read.parameters[place].key, parameter.key);
            assert_eq!(read.parameters[place].row.meaning, parameter.row.meaning);
        }
    }
}

#[test]
fn the_text_of_the_user_keeps_everything_but_the_numbers() {
    for (text, old, new) in [
        (ARM, "xyz=\"2 0 0\"", "xyz=\"2.250000 0 0\""),
        (
            YAML,
            "[-2.0, 0.0, 3.5] # left",
            "[-1.750000, 0.0, 3.5] # left",
        ),
    ] {
        let dialect = Dialect::of(text).expect("a dialect");
        let read = (dialect.read)("f", text).expect("a robot");
        let mut values: Vec<f64> = read.parameters.iter().map(|one| one.value).collect();
        values[0] += 0.25;
        assert_eq!(read.parameters[0].row.meaning, Meaning::EntryPoint(0));
        let written = read.text_with(text, &values, &rounded);
        assert_eq!(written, text.replace(old, new));
    }
}

#[test]
fn what_is_wrong_with_a_text_of_geometry_is_named_with_its_place() {
    for (text, found, replacement, part) in [
        (
            ARM,
            "name=\"anchor_2\"",
            "name=\"anchor_3\"",
            "line 12: <joint>: found no anchor_2, expected the end of its cable",
        ),
        (
            ARM,
            "xyz=\"2 0 0\"",
            "xyz=\"${a} 0 0\"",
            "line 10: <origin>: found xyz=\"${a} 0 0\", expected 3 numbers",
        ),
        (
            ARM,
            "<parent link=\"frame\"/><child link=\"box\"/>",
            "<parent link=\"rail\"/><child link=\"box\"/>",
            "line 3: <robot>: found \"box\" within \"rail\", expected a frame of this file",
        ),
        (
            ARM,
            "<parent link=\"world\"/>",
            "<parent link=\"frame\"/>",
            "line 3: <robot>: found \"box\" within \"frame\"",
        ),
        (
            WORLD,
            "name=\"anchor_",
            "name=\"hook_",
            "line 4: <model>: found no cables, expected frames pulley_NAME and anchor_NAME",
        ),
        (
            WORLD,
            "<pose>2 0 3 1",
            "<pose>2 0 1",
            "line 13: <pose>: found \"2 0 1 2 3\", expected 6 numbers",
        ),
        (
            WORLD,
            "<pose>2 0 3",
            "<pose degrees=\"true\">2 0 3",
            "line 13: <pose>: found \"true\", expected angles in radians",
        ),
        (
            WORLD,
            "<mass>4",
            "<mass>four",
            "line 9: <mass>: found \"four\", expected a number",
        ),
        (
            YAML,
            "-0.3",
            "left",
            "line 11, column 19: points.0.platform.1: found \"left\", expected a number",
        ),
        (
            YAML,
            "  platform: [0.6, -0.3, -0.2]\n",
            "",
            "found no points.0.platform.0, expected a number in m",
        ),
    ] {
        let damaged = text.replace(found, replacement);
        let error = read(&[("f", &damaged)]).expect_err(part);
        assert!(error.contains(part), "{error} lacks {part}");
    }
}

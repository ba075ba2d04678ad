use std::f64::consts::PI;

use tautline_core::geometry::{Coordinate, Pose};
use tautline_core::kinematics::inverse_kinematics;

use super::*;

const BODIES: &str = r#"<?xml version="1.0" encoding="utf-8"?>
<links display_range="-8 8 -6 6 0 6">
  <link_rigid num="1" name="Box">
    <joint type="SPATIAL_EULER_XYZ" />
    <physical><mass>12.5</mass><com_location>0 0 0.1</com_location></physical>
    <parent><num>0</num><location>0.0 0.0 0.0</location></parent>
  </link_rigid>
</links>"#;

/// One cable over a pulley, one from a point; the second is placed by the centre of mass.
const CABLES: &str = r#"<?xml version="1.0" encoding="utf-8"?>
<!DOCTYPE cables SYSTEM "../../../../templates/cables.dtd">
<cables default_cable_set="used">
  <cable_set id="other"></cable_set>
  <cable_set id="used">
    <cable_ideal name="cable 1" attachment_reference="joint">
      <attachments>
        <base_rotating_pulley>
          <fixed_location>0 0 0</fixed_location>
          <pulley_radius>0.1</pulley_radius>
          <cable_entry_vector>0 0 2</cable_entry_vector>
        </base_rotating_pulley>
        <attachment><link>1</link><location>0.1 0 0</location></attachment>
      </attachments>
    </cable_ideal>
    <!-- a comment -->
    <cable_linear_spring name="cable 2" attachment_reference="com">
      <properties><K>100</K></properties>
      <attachments>
        <attachment><link>0</link><location>4 0 3</location></attachment>
        <attachment><link>1</link><location>0 0 -0.1</location></attachment>
      </attachments>
    </cable_linear_spring>
  </cable_set>
</cables>"#;

fn read(files: &[(&str, &str)]) -> Result<Loaded<Robot>, String> {
    let folder = tempfile::tempdir().expect("a folder");
    let paths: Vec<PathBuf> = files
        .iter()
        .map(|(name, text)| {
            let path = folder.path().join(name);
            std::fs::write(&path, text).expect("written");
            path
        })
        .collect();
    let prefix = format!("{}/", folder.path().display());
    read_robot_description(&paths).map_err(|error| error.to_string().replace(&prefix, ""))
}

#[test]
fn lengths_of_a_model_of_caspr_are_those_computed_by_hand() {
    let read = read(&[("Box_cables.xml", CABLES), ("Box_bodies.xml", BODIES)]).expect("a robot");
    let robot = read.value;
    assert_eq!((robot.name.as_str(), robot.cables.len()), ("Box", 2));
    assert_eq!(robot.platform.mass_kg, Some(12.5));
    assert_eq!(robot.platform.free, Coordinate::ALL);
    let lengths = inverse_kinematics(
        &robot,
        &Pose::from_parts([1.0, 0.0, 0.1], [1.0, 0.0, 0.0, 0.0]),
    )
    .expect("lengths");
    // The first cable comes up along z, turns by a quarter around the pulley of 0.1 m, whose centre is at x = 0.1, leaves it
    // at (0.1, 0, 0.1) along x, and ends at (1.1, 0, 0.1).
    assert!(
        (lengths[0].length_m - (0.1 * PI / 2.0 + 1.0)).abs() < 1e-12,
        "{}",
        lengths[0].length_m
    );
    // The second ends at (1, 0, 0.1), where its anchor is the origin of the platform: from (4, 0, 3).
    assert!(
        (lengths[1].length_m - (3.0_f64.powi(2) + 2.9_f64.powi(2)).sqrt()).abs() < 1e-12,
        "{}",
        lengths[1].length_m
    );
    assert_eq!(robot.cables[0].winch.cable_per_revolution_m(), 1.0);
    assert_eq!(read.notices.len(), 2, "{:?}", read.notices);
    assert!(
        read.notices[0].contains("line 17: stiffness of <cable_linear_spring> left out"),
        "{}",
        read.notices[0]
    );
}

#[test]
fn cables_alone_make_a_robot_of_six_degrees_of_freedom() {
    let robot = read(&[("a.xml", CABLES)]).expect("a robot");
    assert_eq!(robot.value.platform.free.len(), 6);
    assert!(robot.notices[0].contains("without the file of the bodies"));
    let planar = BODIES.replace("SPATIAL_EULER_XYZ", "PLANAR_XZ");
    let robot = read(&[("b.xml", &planar), ("a.xml", CABLES)])
        .expect("a robot")
        .value;
    assert_eq!(
        robot.platform.free,
        [Coordinate::X, Coordinate::Z, Coordinate::Ry]
    );
    assert_eq!(robot.tolerances, Some(PartTolerances::typical()));
}

#[test]
fn what_is_wrong_is_named_with_its_place() {
    for (cables, bodies, part) in [
        (
            CABLES.replace("4 0 3", "4 0"),
            BODIES.to_owned(),
            "a.xml, line 20: <location>: found \"4 0\", expected 3 numbers",
        ),
        (
            CABLES.replace("base_rotating_pulley>", "screw_base_rotating_pulley>"),
            BODIES.to_owned(),
            "line 8: <screw_base_rotating_pulley>",
        ),
        (
            CABLES.replace(
                "\"used\">\n  <cable_set id=\"other\"",
                "\"lost\">\n  <cable_set id=\"other\"",
            ),
            BODIES.to_owned(),
            "found no cable_set \"lost\"",
        ),
        (
            CABLES.replace("</cables>", ""),
            BODIES.to_owned(),
            "a.xml: ends within an element",
        ),
        (
            CABLES.replace("</cable_set>\n</cables>", "</cables>"),
            BODIES.to_owned(),
            "is not XML",
        ),
        (
            CABLES.to_owned(),
            BODIES.replace("SPATIAL_EULER_XYZ", "R_X"),
            "b.xml, line 4: <joint>: found the type \"R_X\"",
        ),
        (
            CABLES.to_owned(),
            BODIES.replace("0.0 0.0 0.0", "1 0 0"),
            "whose joint is not at the origin",
        ),
    ] {
        let error = read(&[("a.xml", &cables), ("b.xml", &bodies)]).expect_err(part);
        assert!(error.contains(part), "{error} lacks {part}");
    }
    assert!(
        read(&[("b.xml", BODIES)])
            .expect_err("bodies only")
            .contains("expected the file of the cables")
    );
}

/// One cable over a pulley whose axis is x, one from a point of radius 0; as WireX writes them.
const WIREX: &str = include_str!("../../../tests/fuzz/seeds/foreign_file/model.wcrfx");

/// Length of a cable of WireX: the arc from the base point to the tangent point, by the law of cosines in the triangle of
/// base point, centre of the pulley and anchor, and the straight rest.
fn wirex_length(base: [f64; 3], axis: [f64; 3], radius: f64, anchor: [f64; 3]) -> f64 {
    let sum = |a: [f64; 3], scale: f64, b: [f64; 3]| [0, 1, 2].map(|i| a[i] + scale * b[i]);
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let norm = |a: [f64; 3]| dot(a, a).sqrt();
    let to_anchor = sum(anchor, -1.0, base);
    let radial = sum(to_anchor, -dot(to_anchor, axis), axis);
    let center = sum(base, radius / norm(radial), radial);
    let distance = norm(sum(anchor, -1.0, center));
    let at_center = ((distance * distance + radius * radius - dot(to_anchor, to_anchor))
        / (2.0 * distance * radius))
        .acos();
    let tangent = (radius / distance).acos();
    let arc = if dot(to_anchor, axis) > 0.0 {
        at_center - tangent
    } else {
        2.0 * PI - at_center - tangent
    };
    arc * radius + (distance * distance - radius * radius).sqrt()
}

#[test]
fn lengths_of_a_model_of_wirex_are_those_of_its_own_equations() {
    let read = read(&[("Box.wcrfx", WIREX)]).expect("a robot");
    let robot = read.value;
    assert_eq!((robot.name.as_str(), robot.cables.len()), ("Box", 2));
    assert_eq!(robot.platform.mass_kg, Some(12.5));
    assert_eq!(robot.platform.center_of_mass_m, [0.0, 0.0, 0.1]);
    assert_eq!(robot.platform.free, Coordinate::ALL);
    for position in [[1.0, 0.3, 0.4], [-0.5, 0.8, -0.2], [0.2, -0.6, 0.9]] {
        let pose = Pose::from_parts(position, [1.0, 0.0, 0.0, 0.0]);
        let lengths = inverse_kinematics(&robot, &pose).expect("lengths");
        let anchor = [position[0] + 0.1, position[1], position[2]];
        let wirex = wirex_length([0.0; 3], [1.0, 0.0, 0.0], 0.1, anchor);
        let ours = lengths[0].length_m;
        assert!((ours - wirex).abs() < 1e-12, "{position:?}: {ours} {wirex}");
        let straight = [4.0, 0.0, 3.0]
            .iter()
            .zip(position)
            .map(|(a, b)| (a - b).powi(2))
            .sum::<f64>()
            .sqrt();
        assert!((lengths[1].length_m - straight).abs() < 1e-12);
    }
    for part in [
        "line 9: states no rotation",
        "line 14: inertia left out",
        "does not state whether WireX models pulleys",
        "does not state winches",
    ] {
        let told = read.notices.iter().filter(|notice| notice.contains(part));
        assert_eq!(told.count(), 1, "{part}: {:?}", read.notices);
    }
    assert_eq!(read.notices.len(), 4);
}

#[test]
fn variants_of_models_of_wirex() {
    let planar = WIREX.replace("3R3T", "1R2T");
    let robot = read(&[("a.wcrfx", &planar)]).expect("planar").value;
    assert_eq!(
        robot.platform.free,
        [Coordinate::X, Coordinate::Y, Coordinate::Rz]
    );
    // What WireX writes for a platform of which nobody has said anything.
    let untold = WIREX
        .replace("mass=\"12.5\"", "mass=\"25\"")
        .replace("x=\"0\" y=\"0\" z=\"0.1\"", "x=\"0\" y=\"1\" z=\"0.2\"");
    let robot = read(&[("a.wcrfx", &untold)]).expect("untold");
    assert_eq!(robot.value.platform.mass_kg, None);
    assert_eq!(robot.value.platform.center_of_mass_m, [0.0; 3]);
    assert!(robot.notices.iter().any(|notice| notice.contains("25 kg")));
    let no_radius = WIREX.replace(" radius=\"0.1\"", "");
    let robot = read(&[("a.wcrfx", &no_radius)]).expect("no radius");
    assert_eq!(robot.value.cables[0].pulley.radius_m, 0.1);
    assert!(
        robot
            .notices
            .iter()
            .any(|notice| notice.contains("line 5: states no radius"))
    );
}

#[test]
fn what_is_wrong_with_a_model_of_wirex_is_named_with_its_place() {
    for (found, replacement, part) in [
        (
            "3R3T",
            "2R3T",
            "a.wcrfx, line 2: <robot>: found the motion pattern \"2R3T\"",
        ),
        (
            "x=\"4\" ",
            "",
            "a.wcrfx, line 9: <base>: found no x, expected x, y, z",
        ),
        (
            "x=\"4\"",
            "x=\"four\"",
            "line 9: <base>: found x=\"four\", expected a number",
        ),
        (
            "a13=\"1\"",
            "a13=\"2\"",
            "line 5: <base>: found a13, a23, a33 of length 2.0000",
        ),
        ("<robot generator", "<wireRobot generator", "is not XML"),
        ("</models>", "", "ends within an element"),
    ] {
        let text = WIREX.replace(found, replacement);
        let error = read(&[("a.wcrfx", &text)]).expect_err(part);
        assert!(error.contains(part), "{error} lacks {part}");
    }
    let old = WIREX.replace("robot", "wireRobot");
    assert!(
        read(&[("a.wcrfx", &old)])
            .expect_err("old")
            .contains("line 1: <models>: found no <robot>")
    );
}

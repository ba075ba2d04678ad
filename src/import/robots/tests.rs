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
            "a.xml: ends before its elements do",
        ),
        (
            CABLES.replace("</cable_set>\n</cables>", "</cables>"),
            BODIES.to_owned(),
            "is no XML",
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
    let wirex = "<models><robot><geometry><chain x=\"0\"/></geometry></robot></models>";
    assert!(
        read(&[("a.wcrfx", wirex)])
            .expect_err("WireX")
            .contains("is a robot of WireX, which is not read")
    );
}

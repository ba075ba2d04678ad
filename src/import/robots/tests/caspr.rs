use std::f64::consts::PI;

use tautline_core::geometry::{Coordinate, Pose};
use tautline_core::kinematics::inverse_kinematics;
use tautline_core::robot::{PartTolerances, Robot, presets};

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
pub(super) const CABLES: &str = r#"<?xml version="1.0" encoding="utf-8"?>
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
    // CASPR divides K by the length of the cable.
    let stiffness = robot
        .cables
        .iter()
        .map(|cable| cable.cable.axial_stiffness_n);
    let stiffness: Vec<Option<f64>> = stiffness.collect();
    assert_eq!(stiffness, [None, Some(100.0)]);
    assert_eq!(read.notices.len(), 2, "{:?}", read.notices);
    assert!(
        read.notices[0].contains("the cable set \"used\" is used; for \"other\" change"),
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
            BODIES.replace("SPATIAL_EULER_XYZ", "U_XY"),
            "b.xml, line 4: <joint>: found the type \"U_XY\"",
        ),
        (
            CABLES.to_owned(),
            BODIES.replace("<joint", "<joint actuated=\"true\""),
            "<joint>: found an actuated joint",
        ),
        (
            CABLES.to_owned(),
            BODIES.replace("<joint", "<joint q_initial=\"0 0\""),
            "<joint>: found q_initial=\"0 0\", expected 6 numbers",
        ),
        (
            CABLES.to_owned(),
            BODIES.replace(
                "<joint",
                "<joint q_min=\"0 0 1 0 0 0\" q_max=\"0 0 0 0 0 0\"",
            ),
            "found q_min=1 above q_max=0 in place 3",
        ),
        (
            CABLES.to_owned(),
            BODIES.replace("</links>", "<link_rigid name=\"Arm\"/></links>"),
            "b.xml, line 2: <links>: found the bodies \"Box\", \"Arm\", expected one platform",
        ),
        (
            CABLES.replace("cable_linear_spring", "cable_passive_linear_spring"),
            BODIES.to_owned(),
            "line 17: <cable_passive_linear_spring>: found a passive spring",
        ),
        (
            CABLES.replace("cable_linear_spring", "pneumatic_artificial_muscle"),
            BODIES.to_owned(),
            "found an actuator that is no cable",
        ),
        (
            CABLES.replace("<K>100</K>", "<K>0</K>"),
            BODIES.to_owned(),
            "line 18: <K>: found 0, expected a stiffness",
        ),
    ] {
        let error = read(&[("a.xml", &cables), ("b.xml", &bodies)]).expect_err(part);
        assert!(error.contains(part), "{error} lacks {part}");
    }
    let twice = [("a.xml", CABLES), ("c.xml", CABLES), ("b.xml", BODIES)];
    assert!(
        read(&twice)
            .expect_err("two files of cables")
            .contains("c.xml: describes the same part of a robot as")
    );
    assert!(
        read(&[("b.xml", BODIES)])
            .expect_err("bodies only")
            .contains("expected the file of the cables")
    );
}

/// A platform as CASPR writes it since 2017: the joint of this type, with these attributes, at this place of the base.
fn platform(joint: &str, parent: &str) -> String {
    format!(
        r#"<?xml version="1.0" encoding="utf-8"?>
<!DOCTYPE bodies_system SYSTEM "../../../../templates/bodies.dtd">
<bodies_system>
  <!-- the units are m, kg, rad -->
  <links display_range="-1 3 -1 3 -1 3" view_angle="0 0">
    <link_rigid num="1" name="Link 1">
      <joint {joint}/>
      <physical>
        <mass>2</mass><com_location>0.0 0.5 0.0</com_location><end_location>0.0 0.0 0.0</end_location>
        <inertia ref="joint"><Ixx>1.5</Ixx><Iyy>2</Iyy><Izz>3.5</Izz><Ixy>0</Ixy><Ixz>0</Ixz><Iyz>0</Iyz></inertia>
      </physical>
      <parent><num>0</num><location>{parent}</location></parent>
    </link_rigid>
  </links>
</bodies_system>"#
    )
}

/// Cables from points of the base to points of the platform; name, limits of the tension, both points.
fn crane(cables: &[(&str, [f64; 2], &str, &str)]) -> String {
    let cable = |(name, [least, most], base, end): &(&str, [f64; 2], &str, &str)| {
        format!(
            r#"<cable_ideal name="{name}" attachment_reference="joint">
      <properties><force_min>{least}</force_min><force_max>{most}</force_max></properties>
      <attachments>
        <attachment><link>0</link><location>{base}</location></attachment>
        <attachment><link>1</link><location>{end}</location></attachment>
      </attachments>
    </cable_ideal>
"#
        )
    };
    let cables: String = cables.iter().map(cable).collect();
    format!("<cables default_cable_set=\"a\"><cable_set id=\"a\">\n{cables}</cable_set></cables>")
}

fn four_corners() -> String {
    crane(&[
        ("1", [1.0, 80.0], "0 0 0", "0 0 0"),
        ("2", [5.0, 100.0], "2 0 0", "0 0 0"),
        ("3", [1.0, 100.0], "0 0 2", "0 0 0"),
        ("1", [1.0, 100.0], "2 0 2", "0 0 0"),
    ])
}

#[test]
fn a_joint_becomes_freedom_home_and_workspace() {
    use Coordinate::{Rx, Ry, Rz, X, Y, Z};
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let level = [1.0, 0.0, 0.0, 0.0];
    // Type, q_initial, q_min, q_max; free coordinates, home, centre and half extents of the workspace, largest rotation.
    for (joint, free, home, centre, extent, turn) in [
        (
            ["P_XZ", "1 0.5", "0 -2", "2 1"],
            vec![X, Z],
            ([1.0, 0.0, 0.5], level),
            ([1.0, 0.0, -0.5], level),
            [1.0, 0.0, 1.5],
            0.0,
        ),
        (
            ["P_XY", "1 0.5", "0 -2", "2 1"],
            vec![X, Y],
            ([1.0, 0.5, 0.0], level),
            ([1.0, -0.5, 0.0], level),
            [1.0, 1.5, 0.0],
            0.0,
        ),
        (
            ["P_X", "1", "0", "3"],
            vec![X],
            ([1.0, 0.0, 0.0], level),
            ([1.5, 0.0, 0.0], level),
            [1.5, 0.0, 0.0],
            0.0,
        ),
        (
            ["T_XYZ", "1 1 1", "0 0 0", "2 2 1"],
            vec![X, Y, Z],
            ([1.0, 1.0, 1.0], level),
            ([1.0, 1.0, 0.5], level),
            [1.0, 1.0, 0.5],
            0.0,
        ),
        (
            [
                "PLANAR_XZ",
                "1 0.5 1.570796326794897",
                "0 0 -3.1416",
                "2 1 3.1416",
            ],
            vec![X, Z, Ry],
            ([1.0, 0.0, 0.5], [half, 0.0, half, 0.0]),
            ([1.0, 0.0, 0.5], [half, 0.0, half, 0.0]),
            [1.0, 0.0, 0.5],
            0.1,
        ),
        (
            ["PLANAR_YZ", "0 0 0", "-1 -1 -0.5", "1 1 0.5"],
            vec![Y, Z, Rx],
            ([0.0; 3], level),
            ([0.0; 3], level),
            [0.0, 1.0, 1.0],
            0.5,
        ),
        (
            ["PLANAR_XY", "0 0 0", "-1 -1 -0.2", "1 1 0.2"],
            vec![X, Y, Rz],
            ([0.0; 3], level),
            ([0.0; 3], level),
            [1.0, 1.0, 0.0],
            0.2,
        ),
        (
            [
                "SPATIAL_QUATERNION",
                "1 1 1 0 1 0 0",
                "0 0 0 -1 -1 -1 -1",
                "2 2 2 1 1 1 1",
            ],
            Coordinate::ALL.to_vec(),
            ([1.0; 3], [0.0, 1.0, 0.0, 0.0]),
            ([1.0; 3], [0.0, 1.0, 0.0, 0.0]),
            [1.0; 3],
            0.1,
        ),
        (
            ["R_Z", "0", "-0.3", "0.3"],
            vec![Rz],
            ([0.0; 3], level),
            ([0.0; 3], level),
            [0.0; 3],
            0.3,
        ),
    ] {
        let [kind, initial, low, high] = joint;
        let joint =
            format!("type=\"{kind}\" q_initial=\"{initial}\" q_min=\"{low}\" q_max=\"{high}\"");
        let bodies = platform(&joint, "0 0 0.25");
        let read = read(&[("a_cables.xml", &four_corners()), ("b.xml", &bodies)]).expect(kind);
        let robot = read.value;
        let moved = |([x, y, z], turn): ([f64; 3], [f64; 4])| {
            // The joint is at 0.25 m above the origin of the base.
            Pose::from_parts([x, y, z + 0.25], turn)
        };
        let close = |found: Pose, expected: Pose| found.difference(&expected).amax() < 1e-12;
        assert_eq!(robot.platform.free, free, "{kind}");
        assert!(close(robot.home.expect(kind).pose(), moved(home)), "{kind}");
        let limits = robot.limits.expect(kind);
        let workspace = limits.workspace.expect(kind);
        assert!(close(workspace.center.pose(), moved(centre)), "{kind}");
        assert_eq!(workspace.half_extent_m, extent, "{kind}");
        assert!((workspace.half_rotation_rad - turn).abs() < 1e-12, "{kind}");
        let tension = limits.tension.expect(kind);
        let found = [tension.lower_n, tension.reference_n, tension.upper_n];
        assert_eq!(found, [5.0, 42.5, 80.0]);
        assert_eq!(robot.cables[3].name, "1 (4)");
        // About the joint 1.5, 2, 3.5; the mass of 2 kg is 0.5 m off along y.
        let inertia = robot.platform.inertia_kg_m2.expect(kind);
        assert_eq!(inertia, [1.0, 2.0, 3.0, 0.0, 0.0, 0.0]);
        for part in [
            "q_initial is the home pose",
            "line 23: cable 4 has the name \"1\" of cable 1: it is called \"1 (4)\"",
            "limits of the tension differ between the cables; 5 to 80 N",
        ] {
            let told = read.notices.iter().filter(|notice| notice.contains(part));
            assert_eq!(told.count(), 1, "{part}: {:?}", read.notices);
        }
        // Across the plane of a planar robot the pulleys are known.
        let known = robot.cables[0].pulley.entry_point_sd_m.each();
        let is_planar = free
            .iter()
            .filter(|coordinate| coordinate.index() < 3)
            .count()
            == 2;
        let moves = [X, Y, Z].map(|axis| free.contains(&axis));
        // A frame of 2.8 m.
        let expected = moves.map(|moves| Some(if is_planar && !moves { 0.0 } else { 7e-3 }));
        assert_eq!(known, expected, "{kind}");
    }
}

#[test]
fn fixed_angles_turn_about_the_axes_of_the_base() {
    let joint = "type=\"S_FIXED_XYZ\" q_initial=\"0.3 -0.2 0.5\"";
    let bodies = platform(joint, "1 0 1");
    let robot = read(&[("a.xml", &four_corners()), ("b.xml", &bodies)]).expect("a robot");
    let about = |axis: usize, angle: f64| {
        let mut angles = [0.0; 3];
        angles[axis] = angle;
        Pose::from_angles([0.0; 3], angles).orientation
    };
    let expected = about(2, 0.5) * about(1, -0.2) * about(0, 0.3);
    let home = robot.value.home.expect("a home").pose();
    assert!(home.orientation.angle_to(&expected) < 1e-12);
    assert_eq!(
        robot.value.limits.expect("limits of the tension").workspace,
        None
    );
}

#[test]
fn two_cables_may_leave_one_point() {
    let crane = crane(&[
        ("1", [0.0, 1e3], "-3 -1.7321 3", "0 -0.866 0"),
        ("2", [0.0, 1e3], "-3 -1.7321 3", "-0.75 0.433 0"),
        ("3", [0.0, 1e3], "3 -1.7321 3", "0 -0.866 0"),
    ]);
    read(&[("a.xml", &crane)]).expect("a crane");
    let twice = crane.replace("-0.75 0.433 0", "0 -0.866 0");
    let error = read(&[("a.xml", &twice)]).expect_err("one cable twice");
    assert!(error.contains("two pulleys in one place"), "{error}");
}

#[test]
fn limits_of_tension_that_contradict_each_other_are_left_out() {
    let crane = crane(&[
        ("1", [50.0, 80.0], "0 0 0", "0 0 0"),
        ("2", [90.0, 100.0], "2 0 0", "0 0 0"),
    ]);
    let robot = read(&[("a.xml", &crane)]).expect("a robot");
    assert_eq!(robot.value.limits, None);
    let told = |notice: &String| notice.contains("nothing in common: left out");
    assert!(robot.notices.iter().any(told), "{:?}", robot.notices);
    let reversed = crane.replace("<force_max>80", "<force_max>40");
    let error = read(&[("a.xml", &reversed)]).expect_err("reversed");
    assert!(
        error.contains("found force_min 50 and force_max 40"),
        "{error}"
    );
}

/// The robot that CASPR has of the new files of a robot.
fn written(robot: &Robot) -> Robot {
    let dialect = Dialect::of(CABLES).expect("a dialect");
    let bodies = dialect.bodies.expect("bodies")(robot);
    let cables = (dialect.new_text)(robot);
    let files = [("a_cables.xml", &*cables), ("a_bodies.xml", &*bodies)];
    read(&files).expect("a robot").value
}

#[test]
fn new_files_are_read_as_the_same_robot() {
    let mut robot = presets::find("mini").expect("a preset").robot;
    robot.cables[2].pulley.radius_m = 0.0;
    robot.cables[3].cable.axial_stiffness_n = None;
    robot.platform.mass_kg = Some(7.5);
    robot.platform.center_of_mass_m = [0.01, 0.02, 0.03];
    robot.platform.inertia_kg_m2 = Some([1.0, 2.0, 2.5, 0.1, 0.2, 0.3]);
    robot.home.as_mut().expect("a home").orientation_wxyz = [0.8, 0.0, 0.36, 0.48];
    let again = written(&robot);
    let close = |found: &[f64], expected: &[f64]| {
        let pairs = found.iter().zip(expected);
        pairs.for_each(|(a, b)| assert!((a - b).abs() < 1e-8, "{found:?} {expected:?}"));
    };
    for (old, new) in robot.cables.iter().zip(&again.cables) {
        assert_eq!(old.name, new.name);
        close(&new.pulley.entry_point_m, &old.pulley.entry_point_m);
        close(&new.platform_anchor_m, &old.platform_anchor_m);
        close(&[new.pulley.radius_m], &[old.pulley.radius_m]);
        if old.pulley.radius_m > 0.0 {
            close(&new.pulley.swivel_axis, &old.pulley.swivel_axis);
        }
        assert_eq!(new.cable.axial_stiffness_n, old.cable.axial_stiffness_n);
    }
    let limits = |robot: &Robot| robot.limits.and_then(|limits| limits.tension);
    assert_eq!(limits(&again).is_some(), limits(&robot).is_some());
    assert_eq!(again.platform.mass_kg, Some(7.5));
    assert_eq!(again.platform.free, Coordinate::ALL);
    close(&again.platform.center_of_mass_m, &[0.01, 0.02, 0.03]);
    let inertia = again.platform.inertia_kg_m2.expect("an inertia");
    close(&inertia, &[1.0, 2.0, 2.5, 0.1, 0.2, 0.3]);
    let [old, new] = [&robot, &again].map(|robot| robot.home.expect("a home").pose());
    assert!(new.difference(&old).norm() < 1e-8);
}

#[test]
fn a_planar_robot_keeps_its_joint_and_its_plane() {
    use Coordinate::{Ry, X, Y, Z};
    let mut robot = presets::find("mini").expect("a preset").robot;
    robot.platform.free = vec![X, Z, Ry];
    let home = robot.home.as_mut().expect("a home");
    home.position_m = [0.1, 0.2, 0.3];
    home.orientation_wxyz = [0.8, 0.0, 0.6, 0.0];
    let again = written(&robot);
    assert_eq!(again.platform.free, [X, Z, Ry]);
    let [old, new] = [&robot, &again].map(|robot| robot.home.expect("a home").pose());
    assert!(new.difference(&old).norm() < 1e-8);
    robot.platform.free = vec![X, Y, Z, Ry];
    assert_eq!(written(&robot).platform.free, Coordinate::ALL);
}

#[test]
fn the_cables_of_the_user_keep_everything_but_the_numbers() {
    let dialect = Dialect::of(CABLES).expect("a dialect");
    assert_eq!(dialect.name, "caspr");
    let read = (dialect.read)("f", CABLES).expect("a robot");
    let meanings: Vec<Meaning> = read.parameters.iter().map(|one| one.row.meaning).collect();
    let points = |of: fn(usize) -> Meaning| [0, 1, 2].map(of);
    let [entry, anchor] = [Meaning::EntryPoint, Meaning::Anchor].map(points);
    // The second cable ends at a point that is placed by the centre of mass, which the file does not have.
    let from_mass = points(Meaning::AnchorFromMass);
    assert_eq!(meanings, [entry, anchor, entry, from_mass].concat());
    let mut values: Vec<f64> = read.parameters.iter().map(|one| one.value).collect();
    (values[1], values[6], values[11]) = (0.25, 4.5, -0.2);
    let new = CABLES
        .replace("<fixed_location>0 0 0<", "<fixed_location>0 0.250000 0<")
        .replace("4 0 3", "4.500000 0 3")
        .replace("0 0 -0.1<", "0 0 -0.200000<");
    assert_eq!(read.text_with(CABLES, &values, &rounded), new);
    let error = (dialect.read)("f", BODIES).expect_err("bodies").to_string();
    assert!(error.contains("found no cable_set"), "{error}");
}

use tautline_core::geometry::Coordinate;
use tautline_core::robot::presets;

use super::read;
use crate::Dialect;

const CABLES: &str =
    include_str!("../../../../tests/suites/fuzz/seeds/foreign_file/cables.mjcf.xml");

#[test]
fn tendons_between_sites_are_cables_from_eyelets() {
    let read = read(&[("cables.xml", CABLES)]).expect("a robot");
    let robot = read.value;
    assert_eq!(robot.cables.len(), 8);
    assert_eq!(robot.platform.free, Coordinate::ALL);
    assert_eq!(robot.platform.mass_kg, Some(3.2));
    assert_eq!(robot.platform.center_of_mass_m, [0.0, 0.0, 0.005]);
    assert_eq!(robot.gravity_m_s2, [0.0, 0.0, -9.81]);
    let cable = &robot.cables[2];
    assert_eq!(cable.pulley.entry_point_m, [-1.15, -0.85, 0.05]);
    assert_eq!(cable.pulley.radius_m, 0.0);
    for (found, expected) in cable.platform_anchor_m.iter().zip([-0.12, -0.09, 0.08]) {
        assert!((found - expected).abs() < 1e-12);
    }
    // 35 kN/m of a tendon as long as at the pose in the file.
    let length = [1.03_f64, 0.76, 1.03]
        .iter()
        .map(|d| d * d)
        .sum::<f64>()
        .sqrt();
    let stiffness = cable.cable.axial_stiffness_n.expect("stiffness");
    assert!((stiffness - 35_000.0 * length).abs() < 1e-6, "{stiffness}");
    assert!(
        read.notices
            .iter()
            .any(|notice| notice.contains("left out: actuator;")),
        "{:?}",
        read.notices
    );
}

#[test]
fn bodies_may_be_turned() {
    // The body of a fixed site turned by 90 degrees about z, in degrees and as a quaternion; its site moves accordingly.
    let plain = "pos=\"1.15 0.85 0.05\"><site name=\"frame_1\" pos=\"0 0 0\"";
    for turn in ["euler=\"0 0 1.5707963267948966\"", "quat=\"1 0 0 1\""] {
        let turned = format!("pos=\"1 0.85 0.05\" {turn}><site name=\"frame_1\" pos=\"0 -0.15 0\"");
        let text = CABLES.replace(plain, &turned);
        assert_ne!(text, CABLES);
        let robot = read(&[("cables.xml", &text)]).expect("a robot").value;
        for (found, expected) in robot.cables[0]
            .pulley
            .entry_point_m
            .iter()
            .zip([1.15, 0.85, 0.05])
        {
            assert!((found - expected).abs() < 1e-12, "{turn}: {found}");
        }
    }
}

#[test]
fn pulleys_are_written_and_read_again() {
    let mini = presets::find("mini").expect("a preset").robot;
    let dialect = Dialect::of(CABLES).expect("a dialect");
    let text = (dialect.new_text)(&mini);
    let again = (dialect.read)("mini.xml", &text).expect("a robot").robot;
    for (old, new) in mini.cables.iter().zip(&again.cables) {
        assert_eq!(old.name, new.name);
        assert!((old.pulley.radius_m - new.pulley.radius_m).abs() < 1e-9);
        for k in 0..3 {
            assert!((old.pulley.entry_point_m[k] - new.pulley.entry_point_m[k]).abs() < 1e-8);
            assert!((old.pulley.swivel_axis[k] - new.pulley.swivel_axis[k]).abs() < 1e-8);
            assert!((old.platform_anchor_m[k] - new.platform_anchor_m[k]).abs() < 1e-8);
        }
        assert!((old.winch.length_to_pulley_m - new.winch.length_to_pulley_m).abs() < 1e-8);
    }
}

#[test]
fn what_is_wrong_with_a_model_of_mujoco_is_named_with_its_place() {
    for (found, replacement, part) in [
        (
            "site=\"frame_3\"",
            "site=\"frame3\"",
            "line 30: <site>: found no site \"frame3\", expected one in a body of this file",
        ),
        (
            "<freejoint/>",
            "",
            "line 1: <mujoco>: found no moving body in which spatial tendons end",
        ),
        (
            "pos=\"0.12 0.09 0.08\"",
            "pos=\"0.12 0.09\"",
            "line 17: <site>: found pos=\"0.12 0.09\", expected 3 numbers",
        ),
        ("<worldbody>", "<world>", "is not XML"),
        (
            "angle=\"radian\"",
            "eulerseq=\"ZYX\"",
            "found eulerseq \"ZYX\", expected xyz",
        ),
    ] {
        let error = read(&[("a.xml", &CABLES.replacen(found, replacement, 1))]).expect_err(part);
        assert!(error.contains(part), "{error} lacks {part}");
    }
}

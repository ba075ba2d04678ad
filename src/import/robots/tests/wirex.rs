use std::f64::consts::PI;

use tautline_core::geometry::{Coordinate, Pose};
use tautline_core::kinematics::inverse_kinematics;
use tautline_core::robot::presets;

use super::{read, rounded};
use crate::Dialect;

/// One cable over a pulley whose axis is x, one from a point of radius 0; as WireX writes them.
pub(super) const WIREX: &str =
    include_str!("../../../../tests/suites/fuzz/seeds/foreign_file/model.wcrfx");

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
    // The output of WireX for a platform without any settings.
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

#[test]
fn a_new_model_is_read_as_the_same_robot() {
    let mut robot = presets::find("mini").expect("a preset").robot;
    robot.platform.mass_kg = Some(7.5);
    robot.platform.center_of_mass_m = [0.01, 0.02, 0.03];
    let dialect = Dialect::of(WIREX).expect("a dialect");
    let text = (dialect.new_text)(&robot);
    let again = read(&[("new.wcrfx", &text)]).expect("a robot").value;
    let close = |found: &[f64], expected: &[f64]| {
        let pairs = found.iter().zip(expected);
        pairs.for_each(|(a, b)| assert!((a - b).abs() < 1e-8, "{found:?} {expected:?}"));
    };
    assert_eq!(again.cables.len(), robot.cables.len());
    for (old, new) in robot.cables.iter().zip(&again.cables) {
        assert_eq!(old.name, new.name);
        close(&new.pulley.entry_point_m, &old.pulley.entry_point_m);
        close(&new.platform_anchor_m, &old.platform_anchor_m);
        close(&[new.pulley.radius_m], &[old.pulley.radius_m]);
        close(&new.pulley.swivel_axis, &old.pulley.swivel_axis);
    }
    assert_eq!(again.platform.mass_kg, Some(7.5));
    close(&again.platform.center_of_mass_m, &[0.01, 0.02, 0.03]);
    for free in [
        vec![Coordinate::X, Coordinate::Y, Coordinate::Rz],
        vec![Coordinate::X, Coordinate::Y],
        Coordinate::ALL.to_vec(),
    ] {
        robot.platform.free.clone_from(&free);
        let read = (dialect.read)("new", &(dialect.new_text)(&robot));
        assert_eq!(read.expect("a robot").robot.platform.free, free);
    }
}

#[test]
fn the_model_of_the_user_keeps_everything_but_the_numbers() {
    let dialect = Dialect::of(WIREX).expect("a dialect");
    assert_eq!(dialect.name, "wirex");
    let read = (dialect.read)("f", WIREX).expect("a robot");
    assert_eq!(read.parameters.len(), 12);
    let mut values: Vec<f64> = read.parameters.iter().map(|one| one.value).collect();
    (values[3], values[8]) = (0.125, 3.5);
    let new = WIREX
        .replace("<platform x=\"0.1\"", "<platform x=\"0.125000\"")
        .replace("z=\"3\" radius", "z=\"3.500000\" radius");
    assert_eq!(read.text_with(WIREX, &values, &rounded), new);
}

//! Klipper and Maslow 4.

use tautline_core::geometry::Coordinate;

use super::{read, rounded};
use crate::Dialect;

const PRINTER: &str = include_str!("../../../../tests/suites/fuzz/seeds/foreign_file/printer.cfg");
const MASLOW: &str = include_str!("../../../../tests/suites/fuzz/seeds/foreign_file/maslow.yaml");

#[test]
fn winches_of_klipper() {
    let read_one = read(&[("printer.cfg", PRINTER)]).expect("a robot");
    let robot = read_one.value;
    let names: Vec<&str> = robot
        .cables
        .iter()
        .map(|cable| cable.name.as_str())
        .collect();
    assert_eq!(names, ["a", "b", "c", "d"]);
    assert_eq!(robot.cables[2].pulley.entry_point_m, [-1.402, 0.82, -0.088]);
    let per_revolution = robot.cables[3].winch.cable_per_revolution_m();
    assert!((per_revolution - 0.0403).abs() < 1e-15);
    let geared = PRINTER.replace(
        "rotation_distance: 40.1",
        "rotation_distance = 40\ngear_ratio: 80:16, 3:2 # two stages",
    );
    let robot = read(&[("printer.cfg", &geared)]).expect("gears").value;
    assert!((robot.cables[1].winch.cable_per_revolution_m() - 0.04 / 7.5).abs() < 1e-15);
    for (found, replacement, part) in [
        (
            "anchor_y: 815",
            "anchor_y: none",
            "line 23, column 11: stepper_b.anchor_y: found \"none\", expected a number",
        ),
        (
            "anchor_y: 815\n",
            "",
            "printer.cfg: found no stepper_b.anchor_y, expected a number in mm",
        ),
        (
            "rotation_distance: 40.1",
            "rotation_distance: 40\ngear_ratio: 5",
            "stepper_b.gear_ratio: found \"5\", expected gears",
        ),
    ] {
        let error = read(&[("printer.cfg", &PRINTER.replace(found, replacement))]).expect_err(part);
        assert!(error.contains(part), "{error} lacks {part}");
    }
}

#[test]
fn belts_of_a_maslow() {
    let read_one = read(&[("maslow.yaml", MASLOW)]).expect("a robot");
    let robot = read_one.value;
    assert_eq!(robot.platform.free, [Coordinate::X, Coordinate::Y]);
    assert_eq!(robot.home, None);
    assert_eq!(robot.cables[1].name, "tr");
    for (found, expected) in robot.cables[0]
        .pulley
        .entry_point_m
        .iter()
        .zip([0.0864, 2.6043, 0.0])
    {
        assert!((found - expected).abs() < 1e-12);
    }
    for part in ["shorter by 153.4 mm", "origin at (1717.9, 1323.0) mm"] {
        assert!(
            read_one.notices.iter().any(|notice| notice.contains(part)),
            "{:?}",
            read_one.notices
        );
    }
    let other = MASLOW.replace("    blX", "    tlZ: 100 # mm\n    blX");
    let read_other = read(&[("maslow.yaml", &other)]).expect("a height").notices;
    assert!(
        read_other.iter().any(|notice| notice
            .ends_with("in the plane of the corners: kinematics.MaslowKinematics.tlZ")),
        "{read_other:?}"
    );
    let error = read(&[("maslow.yaml", &MASLOW.replace("brX", "brx"))]).expect_err("no corner");
    assert!(
        error.contains("found no kinematics.MaslowKinematics.brX, expected a number in mm"),
        "{error}"
    );
}

#[test]
fn new_texts_describe_the_same_robots() {
    for text in [PRINTER, MASLOW] {
        let dialect = Dialect::of(text).expect("a dialect");
        let robot = (dialect.read)("old", text).expect("a robot").robot;
        let new = (dialect.new_text)(&robot);
        assert_eq!(Dialect::of(&new).map(|one| one.name), Some(dialect.name));
        let again = (dialect.read)("old", &new).expect("the same robot").robot;
        assert_eq!(again.home, robot.home, "{new}");
        for (old, new) in robot.cables.iter().zip(&again.cables) {
            let off = |k: usize| (old.pulley.entry_point_m[k] - new.pulley.entry_point_m[k]).abs();
            assert!((0..3).all(|k| off(k) < 1e-6));
            assert_eq!(old.platform_anchor_m, new.platform_anchor_m);
        }
    }
}

#[test]
fn damaged_texts_are_read_or_refused_in_one_sentence() {
    let config = include_str!("../../../../tests/suites/fuzz/seeds/foreign_file/config.g");
    let model = include_str!("../../../../tests/suites/fuzz/seeds/foreign_file/cables.mjcf.xml");
    let mut state = 1_u64;
    let mut random = |below: usize| {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % below.max(1)
    };
    let [urdf, world, yaml] = super::simulators::ALL;
    let [caspr, wirex] = [super::caspr::CABLES, super::wirex::WIREX];
    for text in [
        PRINTER, MASLOW, config, model, urdf, world, yaml, caspr, wirex,
    ] {
        let dialect = Dialect::of(text).expect("a dialect");
        for _ in 0..400 {
            let mut letters: Vec<char> = text.chars().collect();
            for _ in 0..=random(4) {
                let at = random(letters.len());
                match random(4) {
                    0 => letters.truncate(at),
                    1 => drop(letters.drain(at..(at + 5).min(letters.len()))),
                    2 => letters.extend_from_within(at..),
                    _ => letters.insert(at, ['-', ':', '[', 'é', '9', '\n', '"', '<'][random(8)]),
                }
            }
            let damaged: String = letters.into_iter().collect();
            match (dialect.read)("damaged", &damaged) {
                Ok(read) => {
                    let values: Vec<f64> = read.parameters.iter().map(|one| one.value).collect();
                    assert_eq!(read.text_with(&damaged, &values, &rounded), damaged);
                }
                Err(error) => assert_eq!(error.to_string().lines().count(), 1, "{error}"),
            }
        }
    }
}

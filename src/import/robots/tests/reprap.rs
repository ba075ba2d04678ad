use tautline_core::geometry::Coordinate;

use super::{read, rounded};
use crate::Dialect;

const CONFIG: &str = include_str!("../../../../tests/suites/fuzz/seeds/foreign_file/config.g");

/// Revolutions of a motor of RepRapFirmware for a line position (mm), from the formula in its source: build-up `Q`, radius `R`,
/// strands, lines, teeth of the motor and of the spool.
fn revolutions(line_mm: f64, q: f64, r: f64, [u, o, l, h]: [f64; 4]) -> f64 {
    let per_turn = u * h / (std::f64::consts::TAU * l);
    let k2 = -u * o * q;
    2.0 * per_turn / k2 * ((r * r + k2 * line_mm).sqrt() - r)
}

#[test]
fn a_hangprinter_turns_as_in_its_firmware() {
    let read = read(&[("config.g", CONFIG)]).expect("a robot");
    let robot = read.value;
    assert_eq!((robot.name.as_str(), robot.cables.len()), ("config", 4));
    assert_eq!(
        robot.platform.free,
        [Coordinate::X, Coordinate::Y, Coordinate::Z]
    );
    assert_eq!(robot.platform.mass_kg, Some(1.4));
    for (index, radius) in [62.15, 62.40, 61.90, 62.75].into_iter().enumerate() {
        let gears = [[2.0, 2.0, 2.0, 4.0][index], 1.0, 18.0, 240.0];
        let cable = &robot.cables[index];
        let growth = robot.effects[index].parameters["growth"];
        assert_eq!(
            robot.effects[index].targets,
            std::slice::from_ref(&cable.name)
        );
        let per_revolution = cable.winch.cable_per_revolution_m();
        for line_mm in [-900.0, -50.0, 0.0, 300.0, 1200.0] {
            let turned = revolutions(line_mm, 0.095, radius, gears);
            let paid_mm = 1e3 * per_revolution * turned * (1.0 + growth * turned);
            assert!((paid_mm - line_mm).abs() < 1e-9, "{paid_mm} {line_mm}");
        }
        assert_eq!(cable.cable.axial_stiffness_n, Some(32_000.0));
    }
    let [_, _, c, d] = &robot.cables[..] else {
        panic!("four")
    };
    assert_eq!(d.name, "D");
    for k in 0..3 {
        assert!((c.pulley.entry_point_m[k] - [-1.2291, 0.7118, -0.1213][k]).abs() < 1e-12);
    }
    for part in [
        "the origin of the firmware",
        "M666 J, M669 P",
        "have the axial stiffness S",
        "does not state noise",
    ] {
        assert!(
            read.notices.iter().any(|notice| notice.contains(part)),
            "{part}: {:?}",
            read.notices
        );
    }
}

#[test]
fn variants_of_a_hangprinter() {
    // Three lines in a plane, as of a Slideprinter, with the defaults of the firmware.
    let three = "M669 K6 N3\nm669 a0:-1900:0 b1645.4:950:0 C-1645.4:950:0 ; D9:9:9\n";
    let robot = read(&[("config.g", three)]).expect("three lines").value;
    assert_eq!(robot.cables.len(), 3);
    assert_eq!(robot.platform.mass_kg, None);
    assert!((robot.cables[2].winch.gear_ratio - 25.5).abs() < 1e-12);
    // The seventh anchor has the letter of the kind of machine.
    let letters = ["A", "B", "C", "D", "I", "J", "K", "L"];
    let anchors = letters.iter().enumerate();
    let anchors: Vec<String> = anchors
        .map(|(index, letter)| format!(" {letter}{index}00:0:2000"))
        .collect();
    let eight = format!("M669 K6 N8\nM669{}\n", anchors.concat());
    assert_eq!(
        read(&[("config.g", &eight)])
            .expect("eight lines")
            .value
            .cables
            .len(),
        8
    );
    // The upper anchor by its height, as older firmware has it; the last line holds.
    let height = CONFIG.replace("D4.5:-2.0:2095.0", "D2000") + "M669 D2100.5\n";
    let robot = read(&[("config.g", &height)]).expect("a height").value;
    assert_eq!(robot.cables[3].pulley.entry_point_m, [0.0, 0.0, 2.1005]);
    let even = CONFIG.replace("Q0.095", "Q0");
    assert_eq!(
        read(&[("config.g", &even)])
            .expect("no build-up")
            .value
            .effects,
        []
    );
}

#[test]
fn what_is_wrong_with_a_config_is_named_with_its_place() {
    for (found, replacement, part) in [
        (
            "K6",
            "K3",
            "config.g, line 2, column 7: M669 K: found 3, expected 6, a Hangprinter",
        ),
        (
            "702.4",
            "abc",
            "config.g, line 4, column 34: M669 B.1: found \"abc\", expected a number",
        ),
        (
            "R62.15",
            "R-1",
            "config.g, line 5, column 14: M666 R.0: found -1, expected a positive number",
        ),
        (
            ":2095.0",
            "",
            "config.g: found no M669 D.2, expected a number in mm",
        ),
    ] {
        let text = CONFIG.replace(found, replacement);
        let error = read(&[("config.g", &text)]).expect_err(part);
        assert!(error.contains(part), "{error} lacks {part}");
    }
    let two = read(&[("a.g", CONFIG), ("b.g", CONFIG)]).expect_err("two");
    assert!(
        two.contains("a.g: describes a whole robot, expected no other file beside it"),
        "{two}"
    );
}

#[test]
fn numbers_are_written_in_place_and_the_rest_is_kept() {
    let dialect = Dialect::of(CONFIG).expect("a dialect");
    assert_eq!(dialect.name, "reprap");
    let read = (dialect.read)("config.g", CONFIG).expect("a robot");
    let mut values: Vec<f64> = read.parameters.iter().map(|one| one.value).collect();
    assert_eq!(read.text_with(CONFIG, &values, &rounded), CONFIG);
    let at = |key: &str| {
        read.parameters
            .iter()
            .position(|one| one.key == key)
            .expect("a number")
    };
    values[at("M669 A.1")] = -1418.12345;
    values[at("M666 R.3")] = 62.7504;
    values[at("M666 Q.0")] = 0.0961;
    let written = read.text_with(CONFIG, &values, &rounded);
    let expected = CONFIG
        .replace("-1420.5", "-1418.123")
        .replace("Q0.095", "Q0.096100");
    assert_eq!(written, expected);
}

#[test]
fn a_new_config_describes_the_same_robot() {
    let dialect = Dialect::of(CONFIG).expect("a dialect");
    let robot = (dialect.read)("config.g", CONFIG).expect("a robot").robot;
    let text = (dialect.new_text)(&robot);
    let again = (dialect.read)("config.g", &text)
        .expect("the same robot")
        .robot;
    for (old, new) in robot.cables.iter().zip(&again.cables) {
        assert_eq!(old.name, new.name);
        let [old_m, new_m] = [old, new].map(|cable| cable.winch.cable_per_revolution_m());
        assert!((old_m / new_m - 1.0).abs() < 2e-5, "{old_m} {new_m}");
        let off = |k: usize| (old.pulley.entry_point_m[k] - new.pulley.entry_point_m[k]).abs();
        assert!((0..3).all(|k| off(k) < 1e-6));
    }
    assert_eq!(again.platform.mass_kg, Some(1.4));
}

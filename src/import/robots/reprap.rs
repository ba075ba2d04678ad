//! Hangprinters in `config.g` of RepRapFirmware.
//!
//! A line to the anchor `a` has the position `l = |a - x| - |a|` (mm). With the spool radius `R` at the origin, where the line is
//! wound up, `U` strands, `O` lines on a spool, the build-up `Q` and the gear `H / L`, the motor has turned by
//!
//!     rev = 2 G / k2 (sqrt(R^2 + k2 l) - R),    G = U H / (2 pi L),    k2 = -U O Q,
//!
//! which is the inverse of `l = k rev (1 + g rev)`, with `k = R / G` and the growth `g = k2 / (4 G R)` of the effect `drum_growth`.
//! Where the mover's weight `W` is stated, the firmware subtracts the stretch `F |a - x| / S` of a line.
//! Source: RepRapFirmware, `HangprinterKinematics`; M666 and M669 of the dictionary of G-codes.

use std::f64::consts::PI;

use tautline_core::effect::EffectSetting;
use tautline_core::geometry::Coordinate;
use tautline_core::robot::{FrameTransform, Platform, Robot};
use tautline_session::{ReadError, quoted};

use super::description::{Description, Guide, cable_of, home_at, robot_of};
use super::dialect::{Dialect, ForeignRobot, MM, Meaning, Numbers, ONE, Row};
use super::settings::Settings;

pub(super) static DIALECT: Dialect = Dialect {
    name: "reprap",
    title: "config.g of a Hangprinter with RepRapFirmware",
    is_in,
    read,
    new,
};

/// Letters of the anchors in the order of the motors.
const ANCHORS: [&str; 9] = ["A", "B", "C", "D", "I", "J", "K", "L", "O"];

const ANCHOR: [Row; 3] = [
    Row::anchor("M669 {cable}.0", 0, MM),
    Row::anchor("M669 {cable}.1", 1, MM),
    Row::anchor("M669 {cable}.2", 2, MM),
];
/// Of an anchor above the origin, older firmware states the height alone.
const HEIGHT: Row = Row::anchor("M669 {cable}.0", 2, MM);
const RADIUS: Row = Row {
    key: "M666 R.{index}",
    meaning: Meaning::CablePerRevolution,
    unit: MM,
    default: Some(75.0),
    range: 5.0,
    digits: 3,
};
/// Increase of the squared spool radius per length of line.
const BUILD_UP: Row = Row {
    key: "M666 Q.0",
    meaning: Meaning::BuildUp,
    unit: MM,
    default: Some(0.007),
    range: 0.1,
    digits: 6,
};
const STRANDS: Row = Row::kept("M666 U.{index}", ONE, Some(2.0));
const LINES: Row = Row::kept("M666 O.{index}", ONE, Some(1.0));
const MOTOR_TEETH: Row = Row::kept("M666 L.{index}", ONE, Some(20.0));
const SPOOL_TEETH: Row = Row::kept("M666 H.{index}", ONE, Some(255.0));
const MASS: Row = Row::kept("M666 W.0", ("kg", 1.0), Some(0.0));
const STIFFNESS: Row = Row {
    key: "M666 S.0",
    meaning: Meaning::Stiffness,
    unit: ("N", 1.0),
    default: Some(20_000.0),
    range: 10_000.0,
    digits: 1,
};

fn is_in(text: &str) -> bool {
    let settings = Settings::of_gcode("", text);
    settings.keys().any(|key| key == "M669 A.0")
}

fn read(file: &str, text: &str) -> Result<ForeignRobot, ReadError> {
    let mut numbers = Numbers::of(Settings::of_gcode(file, text));
    check_kinematics(&mut numbers)?;
    let stated = |name: &&&str| numbers.settings.text(&format!("M669 {name}.0")).is_some();
    let default = ANCHORS.iter().take_while(stated).count() as f64;
    let count = numbers.get(&Row::kept("M669 N.0", ONE, Some(default)), None)?;
    let mass_kg = numbers.get(&MASS, None)?;
    let stiffness_n = numbers.positive(&STIFFNESS, None)?;
    let build_up_m = numbers.get(&BUILD_UP, None)?;
    let (mut cables, mut effects) = (Vec::new(), Vec::new());
    for (index, name) in ANCHORS.iter().take(count as usize).enumerate() {
        let at = Some((index, *name));
        let mut cable = cable_of(
            Some((*name).to_owned()),
            index + 1,
            Guide::eyelet(anchor(&mut numbers, at)?),
            [0.0; 3],
        );
        let radius_m = numbers.positive(&RADIUS, at)?;
        let strands = numbers.positive(&STRANDS, at)?;
        let teeth = numbers.positive(&SPOOL_TEETH, at)? / numbers.positive(&MOTOR_TEETH, at)?;
        cable.winch.drum_diameter_m = 2.0 * radius_m;
        cable.winch.gear_ratio = strands * teeth;
        cable.cable.axial_stiffness_n = (mass_kg > 0.0).then_some(stiffness_n);
        let growth = -PI * numbers.positive(&LINES, at)? * build_up_m / (2.0 * teeth * radius_m);
        if growth != 0.0 {
            effects.push(EffectSetting {
                effect: "drum_growth".to_owned(),
                targets: vec![cable.name.clone()],
                parameters: [("growth".to_owned(), growth)].into(),
            });
        }
        cables.push(cable);
    }
    let notices = notices(
        &numbers,
        cables
            .iter()
            .any(|cable| cable.cable.axial_stiffness_n.is_some()),
    );
    let origin = FrameTransform {
        position_m: [0.0; 3],
        orientation_wxyz: [1.0, 0.0, 0.0, 0.0],
    };
    let description = Description {
        platform: Platform {
            free: vec![Coordinate::X, Coordinate::Y, Coordinate::Z],
            ..Platform::spatial(Some(mass_kg).filter(|mass| *mass > 0.0))
        },
        cables,
        home: Some(home_at(origin)),
        limits: None,
        has_winches: true,
    };
    let mut read = robot_of(file, description, notices)?;
    read.value.effects = effects;
    Ok(numbers.described(read.value, read.notices))
}

/// Refuses other kinds of machines.
fn check_kinematics(numbers: &mut Numbers<'_>) -> Result<(), ReadError> {
    let kind = numbers.settings.text("M669 K.0").unwrap_or("6");
    if kind.parse() == Ok(6.0) || kind.trim_matches('"').eq_ignore_ascii_case("hangprinter") {
        return Ok(());
    }
    let message = format!("M669 K: found {}, expected 6, a Hangprinter", quoted(kind));
    Err(numbers.settings.error("M669 K.0", message))
}

/// The anchor of a line (m); of one that is above the origin, the height alone may be stated.
fn anchor(numbers: &mut Numbers<'_>, at: Option<(usize, &str)>) -> Result<[f64; 3], ReadError> {
    let name = at.map_or("", |(_, name)| name);
    let is_stated = |k: usize| numbers.settings.text(&format!("M669 {name}.{k}")).is_some();
    if is_stated(0) && !is_stated(1) {
        return Ok([0.0, 0.0, numbers.get(&HEIGHT, at)?]);
    }
    let [x, y, z] = ANCHOR.map(|row| numbers.get(&row, at));
    Ok([x?, y?, z?])
}

fn notices(numbers: &Numbers<'_>, is_elastic: bool) -> Vec<String> {
    let file = numbers.settings.file;
    let mut notices = vec![format!(
        "{file}: the home pose, at which revolutions are 0, is the origin of the firmware; a positive revolution pays out line, whatever the drivers' directions (M569)"
    )];
    let mut unused = numbers.unused("M666 ");
    unused.extend(
        numbers
            .unused("M669 ")
            .into_iter()
            .filter(|key| key != "M669 K"),
    );
    if !unused.is_empty() {
        notices.push(format!(
            "{file}: left out, as they do not change the geometry: {}",
            unused.join(", ")
        ));
    }
    if is_elastic {
        notices.push(format!(
            "{file}: W states the mass of the mover and S the axial stiffness of a line (N); state limits.tension in robot.json so that stretch is modelled"
        ));
    }
    notices
}

/// A text with the numbers of a robot; gears are the simplest ones with the ratio of the first winch.
fn new(robot: &Robot) -> Result<String, String> {
    if robot.cable_count() > ANCHORS.len() {
        let count = robot.cable_count();
        return Err(format!(
            "found {count} cables, expected at most {} for a Hangprinter",
            ANCHORS.len()
        ));
    }
    let all = |value: &dyn Fn(usize) -> String| {
        let values: Vec<String> = (0..robot.cable_count()).map(value).collect();
        values.join(":")
    };
    let gears: Vec<[u32; 2]> = robot
        .cables
        .iter()
        .map(|cable| fraction(cable.winch.gear_ratio))
        .collect();
    let mut text = format!("M669 K6 N{}\nM669", robot.cable_count());
    for (name, cable) in ANCHORS.iter().zip(&robot.cables) {
        let [x, y, z] = cable.pulley.entry_point_m.map(|value| 1e3 * value);
        text += &format!(" {name}{x:.3}:{y:.3}:{z:.3}");
    }
    let radius = |index: usize| {
        let [spool, motor] = gears[index].map(f64::from);
        let per_revolution_m = robot.cables[index].winch.cable_per_revolution_m();
        format!("{:.3}", 1e3 * per_revolution_m * spool / motor / (2.0 * PI))
    };
    let one = |_: usize| "1".to_owned();
    text += &format!(
        "\nM666 Q0.0 R{}\nM666 U{} O{}\n",
        all(&radius),
        all(&one),
        all(&one)
    );
    let gear = |part: usize| all(&|index| gears[index][part].to_string());
    text += &format!("M666 L{} H{}\n", gear(1), gear(0));
    let stiffness_n = robot.cables[0].cable.axial_stiffness_n;
    if let (Some(mass_kg), Some(stiffness_n)) = (robot.platform.mass_kg, stiffness_n) {
        text += &format!("M666 W{mass_kg} S{stiffness_n:.1}\n");
    }
    Ok(text)
}

/// The fraction with the smallest denominator up to 100 that is closest to a positive number; larger than 0.
fn fraction(number: f64) -> [u32; 2] {
    let off = |denominator: &u32| {
        let numerator = (number * f64::from(*denominator)).round();
        (numerator / f64::from(*denominator) - number).abs()
    };
    let best = (1..=100).reduce(|best, other| {
        if off(&other) < 0.999 * off(&best) {
            other
        } else {
            best
        }
    });
    let denominator = best.unwrap_or(1);
    [
        ((number * f64::from(denominator)).round() as u32).max(1),
        denominator,
    ]
}

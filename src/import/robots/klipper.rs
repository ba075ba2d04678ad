//! Cable winches in `printer.cfg` of Klipper.
//!
//! A stepper is at `|a - x|` (mm), with its anchor `a`; one revolution of its motor winds `rotation_distance` over the product of
//! `gear_ratio`, pairs of numbers of teeth such as `80:16, 57:11`. The nozzle is at the origin when the printer is homed.
//! Source: Klipper, `kinematics/winch.py`, and its configuration reference.

use std::f64::consts::PI;

use tautline_core::geometry::Coordinate;
use tautline_core::robot::{FrameTransform, Platform, Robot};
use tautline_session::{ReadError, quoted};

use super::description::{Description, Guide, cable_of, home_at, robot_of};
use super::dialect::{Dialect, ForeignRobot, MM, Meaning, Numbers, Row};
use super::settings::Settings;

pub(super) static DIALECT: Dialect = Dialect {
    name: "klipper",
    title: "printer.cfg of Klipper with cable winches",
    is_in,
    read,
    new,
};

const ANCHOR: [Row; 3] = [
    Row::anchor("stepper_{cable}.anchor_x", 0, MM),
    Row::anchor("stepper_{cable}.anchor_y", 1, MM),
    Row::anchor("stepper_{cable}.anchor_z", 2, MM),
];
const PER_REVOLUTION: Row = Row {
    key: "stepper_{cable}.rotation_distance",
    meaning: Meaning::CablePerRevolution,
    unit: MM,
    default: None,
    range: 5.0,
    digits: 4,
};

/// Names of the steppers in the order of the winches.
fn names() -> impl Iterator<Item = String> {
    ('a'..='z').map(String::from)
}

fn is_in(text: &str) -> bool {
    let settings = Settings::of_sections("", text);
    settings.text("printer.kinematics") == Some("winch")
}

fn read(file: &str, text: &str) -> Result<ForeignRobot, ReadError> {
    let mut numbers = Numbers::of(Settings::of_sections(file, text));
    let mut cables = Vec::new();
    for (index, name) in names().enumerate() {
        let section = format!("stepper_{name}.");
        if !numbers.settings.keys().any(|key| key.starts_with(&section)) {
            break;
        }
        let at = Some((index, name.as_str()));
        let [x, y, z] = ANCHOR.map(|row| numbers.get(&row, at));
        let guide = Guide::eyelet([x?, y?, z?]);
        let mut cable = cable_of(Some(name.clone()), index + 1, guide, [0.0; 3]);
        cable.winch.drum_diameter_m = numbers.positive(&PER_REVOLUTION, at)? / PI;
        cable.winch.gear_ratio = gear_ratio(&numbers.settings, &format!("{section}gear_ratio"))?;
        cables.push(cable);
    }
    let origin = FrameTransform {
        position_m: [0.0; 3],
        orientation_wxyz: [1.0, 0.0, 0.0, 0.0],
    };
    let description = Description {
        platform: Platform {
            free: vec![Coordinate::X, Coordinate::Y, Coordinate::Z],
            ..Platform::spatial(None)
        },
        cables,
        home: Some(home_at(origin)),
        limits: None,
        has_winches: true,
    };
    let notices = vec![format!(
        "{file}: the home pose, at which revolutions are 0, is the origin of the printer; a positive revolution pays out cable, whatever the sign of dir_pin"
    )];
    let read = robot_of(file, description, notices)?;
    Ok(numbers.described(read.value, read.notices))
}

/// The product of the gears of a stepper, 1 without any.
fn gear_ratio(settings: &Settings<'_>, key: &str) -> Result<f64, ReadError> {
    let Some(text) = settings.text(key) else {
        return Ok(1.0);
    };
    let gear = |pair: &str| {
        let (driven, driving) = pair.split_once(':')?;
        let ratio: f64 = driven.trim().parse::<f64>().ok()? / driving.trim().parse::<f64>().ok()?;
        Some(ratio).filter(|ratio| ratio.is_finite() && *ratio > 0.0)
    };
    let product: Option<f64> = text.split(',').map(gear).product();
    product.ok_or_else(|| {
        let message = format!(
            "{key}: found {}, expected gears such as 80:16, 57:11",
            quoted(text)
        );
        settings.error(key, message)
    })
}

/// Sections with the numbers of a robot; the gears are in the rotation distances.
fn new(robot: &Robot) -> Result<String, String> {
    let mut text = "[printer]\nkinematics: winch\n".to_owned();
    if !(3..=26).contains(&robot.cable_count()) {
        return Err(format!(
            "found {} cables, expected 3 to 26 for Klipper",
            robot.cable_count()
        ));
    }
    for (name, cable) in names().zip(&robot.cables) {
        let distance = 1e3 * cable.winch.cable_per_revolution_m();
        let [x, y, z] = cable.pulley.entry_point_m.map(|value| 1e3 * value);
        text += &format!(
            "\n[stepper_{name}]\nrotation_distance: {distance:.4}\nanchor_x: {x:.3}\nanchor_y: {y:.3}\nanchor_z: {z:.3}\n"
        );
    }
    Ok(text)
}

//! Cable winches in `printer.cfg` of Klipper.
//!
//! A stepper is at `|a - x|` (mm), with its anchor `a`; one revolution of its motor winds `rotation_distance` over the product of
//! `gear_ratio`, pairs of numbers of teeth such as `80:16, 57:11`. The nozzle is at the origin when the printer is homed.
//! Source: Klipper, `kinematics/winch.py`, and its configuration reference.

use std::f64::consts::PI;

use tautline_core::geometry::Coordinate;
use tautline_core::robot::Robot;
use tautline_files::{ReadError, quoted};

use super::description::{Description, Guide, cable_of, robot_of};
use super::dialect::{Dialect, ForeignRobot, MM, Meaning, Setting};
use super::settings::Settings;

pub(super) static DIALECT: Dialect = Dialect {
    name: "klipper",
    has_winches: true,
    is_in: |text| Settings::of_sections("", text).text("printer.kinematics") == Some("winch"),
    read,
    new_text,
    bodies: None,
};

const ANCHOR: [Setting; 3] = [
    Setting::point("stepper_{cable}.anchor_x", 0, MM),
    Setting::point("stepper_{cable}.anchor_y", 1, MM),
    Setting::point("stepper_{cable}.anchor_z", 2, MM),
];
const PER_REVOLUTION: Setting = Setting {
    meaning: Meaning::CablePerRevolution,
    default: None,
    range: 5.0,
    digits: 4,
    ..Setting::kept("stepper_{cable}.rotation_distance", MM, 0.0)
};

fn read(file: &str, text: &str) -> Result<ForeignRobot, ReadError> {
    let mut settings = Settings::of_sections(file, text);
    let mut cables = Vec::new();
    for (index, name) in ('a'..='z').map(String::from).enumerate() {
        let section = format!("stepper_{name}.");
        if index > 0 && !settings.has(&section) {
            break;
        }
        let at = (index, name.as_str());
        let [x, y, z] = ANCHOR.map(|row| settings.get(&row, at));
        let guide = Guide::eyelet([x?, y?, z?]);
        let mut cable = cable_of(Some(name.clone()), index, guide, [0.0; 3]);
        cable.winch.drum_diameter_m = settings.positive(&PER_REVOLUTION, at)? / PI;
        cable.winch.gear_ratio = gear_ratio(&settings, &format!("{section}gear_ratio"))?;
        cables.push(cable);
    }
    let description = Description::of_point(cables, &Coordinate::ALL[..3], true);
    let mut notices = vec![format!(
        "{file}: the home pose, at which revolutions are 0, is the origin of the printer; a positive revolution pays out cable, whatever the sign of dir_pin"
    )];
    // Forks with flexible lines and build-up have such settings.
    let why = "Klipper itself has no such settings";
    notices.extend(settings.left_out(&["printer.winch_"], why));
    Ok(ForeignRobot::new(
        robot_of(file, description, notices)?,
        settings.parameters,
    ))
}

/// The product of the gears of a stepper, 1 without any.
fn gear_ratio(settings: &Settings<'_>, key: &str) -> Result<f64, ReadError> {
    let text = settings.text(key).unwrap_or("1:1");
    let gear = |pair: &str| {
        let (driven, driving) = pair.split_once(':')?;
        let ratio = driven.trim().parse::<f64>().ok()? / driving.trim().parse::<f64>().ok()?;
        Some(ratio).filter(|ratio| ratio.is_finite() && *ratio > 0.0)
    };
    text.split(',')
        .map(gear)
        .product::<Option<f64>>()
        .ok_or_else(|| {
            let message = format!(
                "{key}: found {}, expected gears such as 80:16, 57:11",
                quoted(text)
            );
            settings.error(key, message)
        })
}

fn new_text(robot: &Robot) -> String {
    let mut text = "[printer]\nkinematics: winch\n".to_owned();
    for (name, cable) in ('a'..='z').zip(&robot.cables) {
        let distance = 1e3 * cable.winch.cable_per_revolution_m().abs();
        let [x, y, z] = cable.pulley.entry_point_m.map(|value| 1e3 * value);
        text += &format!(
            "\n[stepper_{name}]\nrotation_distance: {distance:.4}\nanchor_x: {x:.3}\nanchor_y: {y:.3}\nanchor_z: {z:.3}\n"
        );
    }
    text
}

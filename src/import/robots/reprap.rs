//! Hangprinters in `config.g` of RepRapFirmware.
//!
//! A line to the anchor `a` has the position `l = |a - x| - |a|` (mm). With the spool radius `R` at the origin, where the line is
//! wound up, `U` strands, `O` lines on a spool, the build-up `Q` and the gear `H / L`, the motor has turned by
//!
//! ```text
//! rev = 2 G / k2 (sqrt(R^2 + k2 l) - R),    G = U H / (2 pi L),    k2 = -U O Q,
//! ```
//!
//! which is the inverse of `l = k rev (1 + g rev)`, with `k = R / G` and the growth `g = k2 / (4 G R)` of the effect `drum_growth`.
//! Where the mover's weight `W` is stated, the firmware subtracts the stretch `F |a - x| / S` of a line.
//! Source: RepRapFirmware, `HangprinterKinematics`; M666 and M669 of the dictionary of G-codes.

use std::f64::consts::{PI, TAU};

use tautline_core::effect::EffectSetting;
use tautline_core::geometry::Coordinate;
use tautline_core::robot::Robot;
use tautline_files::ReadError;

use super::description::{Description, Guide, cable_of, robot_of};
use super::dialect::{Dialect, ForeignRobot, MM, Meaning, Setting};
use super::settings::Settings;

pub(super) static DIALECT: Dialect = Dialect {
    name: "reprap",
    has_winches: true,
    is_in: |text| Settings::of_gcode("", text).text("M669 A.0").is_some(),
    read,
    new_text,
    bodies: None,
};

/// Letters of the anchors in the order of the motors.
const ANCHORS: [&str; 9] = ["A", "B", "C", "D", "I", "J", "K", "L", "O"];

const ANCHOR: [Setting; 3] = [
    Setting::point("M669 {cable}.0", 0, MM),
    Setting::point("M669 {cable}.1", 1, MM),
    Setting::point("M669 {cable}.2", 2, MM),
];
/// Of an anchor above the origin, older firmware states the height alone.
const HEIGHT: Setting = Setting::point("M669 {cable}.0", 2, MM);
const RADIUS: Setting = Setting {
    meaning: Meaning::CablePerRevolution,
    range: 5.0,
    digits: 3,
    ..Setting::kept("M666 R.{index}", MM, 75.0)
};
/// Increase of the squared spool radius per length of line.
const BUILD_UP: Setting = Setting {
    meaning: Meaning::BuildUp,
    range: 0.1,
    digits: 6,
    ..Setting::kept("M666 Q.0", MM, 0.007)
};
const STRANDS: Setting = Setting::kept("M666 U.{index}", ("strands", 1.0), 2.0);
const LINES: Setting = Setting::kept("M666 O.{index}", ("lines", 1.0), 1.0);
const MOTOR_TEETH: Setting = Setting::kept("M666 L.{index}", ("teeth", 1.0), 20.0);
const SPOOL_TEETH: Setting = Setting::kept("M666 H.{index}", ("teeth", 1.0), 255.0);
const MASS: Setting = Setting::kept("M666 W.0", ("kg", 1.0), 0.0);
const STIFFNESS: Setting = Setting {
    meaning: Meaning::Stiffness,
    range: 10_000.0,
    digits: 1,
    ..Setting::kept("M666 S.0", ("N", 1.0), 20_000.0)
};

fn read(file: &str, text: &str) -> Result<ForeignRobot, ReadError> {
    let mut settings = Settings::of_gcode(file, text);
    let common = (0, "");
    // Three values are an anchor, one is the kind of machine.
    if settings.text("M669 K.1").is_none() {
        let kind = settings.get(&Setting::kept("M669 K.0", ("", 1.0), 6.0), common)?;
        if kind != 6.0 {
            let message = format!("M669 K: found {kind}, expected 6, a Hangprinter");
            return Err(settings.error("M669 K.0", message));
        }
    }
    let is_stated = |name: &&&str| settings.text(&format!("M669 {name}.0")).is_some();
    let stated = ANCHORS.iter().take_while(is_stated).count() as f64;
    let count = settings.get(&Setting::kept("M669 N.0", ("anchors", 1.0), stated), common)?;
    let mass_kg = settings.get(&MASS, common)?;
    let stiffness_n = settings.positive(&STIFFNESS, common)?;
    let build_up_m = settings.get(&BUILD_UP, common)?;
    let (mut cables, mut effects) = (Vec::new(), Vec::new());
    for at in ANCHORS.into_iter().take(count as usize).enumerate() {
        let guide = Guide::eyelet(anchor(&mut settings, at)?);
        let mut cable = cable_of(Some(at.1.to_owned()), at.0, guide, [0.0; 3]);
        let radius_m = settings.positive(&RADIUS, at)?;
        let teeth = settings.positive(&SPOOL_TEETH, at)? / settings.positive(&MOTOR_TEETH, at)?;
        cable.winch.drum_diameter_m = 2.0 * radius_m;
        cable.winch.gear_ratio = settings.positive(&STRANDS, at)? * teeth;
        cable.cable.axial_stiffness_n = (mass_kg > 0.0).then_some(stiffness_n);
        let lines = settings.positive(&LINES, at)?;
        let growth = -PI * lines * build_up_m / (2.0 * teeth * radius_m);
        if growth != 0.0 {
            effects.push(EffectSetting {
                effect: "drum_growth".to_owned(),
                targets: vec![cable.name.clone()],
                parameters: [("growth".to_owned(), growth)].into(),
            });
        }
        cables.push(cable);
    }
    let mut description = Description::of_point(cables, &Coordinate::ALL[..3], true);
    description.platform.mass_kg = Some(mass_kg).filter(|mass| *mass > 0.0);
    let mut notices = vec![
        format!(
            "{file}: the home pose, at which revolutions are 0, is the origin of the firmware; a positive revolution pays out line, whatever the directions of the drivers (M569)"
        ),
        format!(
            "{file}: with the weight W, the lines have the axial stiffness S (N); state limits.tension in robot.json so that their stretch is modelled"
        ),
    ];
    let why = "they do not change the geometry";
    notices.extend(settings.left_out(&["M666 ", "M669 "], why));
    let mut read = robot_of(file, description, notices)?;
    read.value.effects = effects;
    Ok(ForeignRobot::new(read, settings.parameters))
}

/// The anchor of a line (m); of one that is above the origin, the height alone may be stated.
fn anchor(settings: &mut Settings<'_>, at: (usize, &str)) -> Result<[f64; 3], ReadError> {
    let [first, second] = ["0", "1"].map(|k| settings.text(&format!("M669 {}.{k}", at.1)));
    if first.is_some() && second.is_none() {
        return Ok([0.0, 0.0, settings.get(&HEIGHT, at)?]);
    }
    let [x, y, z] = ANCHOR.map(|row| settings.get(&row, at));
    Ok([x?, y?, z?])
}

fn new_text(robot: &Robot) -> String {
    const TEETH: f64 = 20.0;
    let all = |value: &dyn Fn(usize) -> String| {
        let values: Vec<String> = (0..robot.cable_count()).map(value).collect();
        values.join(":")
    };
    let spool = |k: usize| {
        (TEETH * robot.cables[k].winch.gear_ratio.abs())
            .round()
            .max(1.0)
    };
    let radius = |k: usize| {
        let per_revolution = 1e3 * robot.cables[k].winch.cable_per_revolution_m().abs();
        format!("{:.3}", per_revolution * spool(k) / TEETH / TAU)
    };
    let (ones, motor) = (all(&|_| "1".to_owned()), all(&|_| TEETH.to_string()));
    let (radii, spools) = (all(&radius), all(&|k| spool(k).to_string()));
    let mut text = format!("M669 K6 N{}\nM669", robot.cable_count());
    for (name, cable) in ANCHORS.iter().zip(&robot.cables) {
        let [x, y, z] = cable.pulley.entry_point_m.map(|value| 1e3 * value);
        text += &format!(" {name}{x:.3}:{y:.3}:{z:.3}");
    }
    text += &format!("\nM666 Q0.0 R{radii}\nM666 U{ones} O{ones}\nM666 L{motor} H{spools}\n");
    let stiffness = robot
        .cables
        .first()
        .and_then(|cable| cable.cable.axial_stiffness_n);
    if let Some((mass_kg, stiffness_n)) = robot.platform.mass_kg.zip(stiffness) {
        text += &format!("M666 W{mass_kg} S{stiffness_n:.1}\n");
    }
    text
}

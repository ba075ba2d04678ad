//! The effects outside the catalogue as hypothesis files, as an engineer writes them who suspects the right thing.

use std::fmt::Write as _;

use tautline_core::geometry::Vec3;
use tautline_core::measurement::Measurements;
use tautline_core::robot::Robot;

use crate::tables::hidden::Scene;

/// Smallest and largest typical error of lengths and distances (m), tensions (N) and angles (rad).
const LENGTH_M: [f64; 2] = [1e-4, 1e-2];
const TENSION_N: [f64; 2] = [0.3, 30.0];
const ANGLE_RAD: [f64; 2] = [1e-3, 1e-1];

/// A parameter of a file.
struct Parameter {
    name: &'static str,
    unit: &'static str,
    typical: [f64; 2],
    is_phase: bool,
}

/// What a hypothesis file states.
pub struct File {
    scope: &'static str,
    parameters: Vec<Parameter>,
    /// What changes, and its formula.
    change: Vec<(&'static str, String)>,
}

impl File {
    pub fn new(scope: &'static str, target: &'static str, formula: impl Into<String>) -> Self {
        Self {
            scope,
            parameters: Vec::new(),
            change: vec![(target, formula.into())],
        }
    }

    fn and(mut self, target: &'static str, formula: String) -> Self {
        self.change.push((target, formula));
        self
    }

    /// With a parameter.
    pub fn with(mut self, name: &'static str, unit: &'static str, typical: [f64; 2]) -> Self {
        self.parameters.push(Parameter {
            name,
            unit,
            typical,
            is_phase: false,
        });
        self
    }

    fn with_phase(mut self) -> Self {
        let pi = std::f64::consts::PI;
        self.parameters.push(Parameter {
            name: "phase",
            unit: "rad",
            typical: [-pi, pi],
            is_phase: true,
        });
        self
    }

    /// Whether it acts on one cable.
    pub fn is_of_cable(&self) -> bool {
        self.scope == "cable"
    }

    /// The text of the file.
    pub fn text(&self, id: &str) -> String {
        let of = match self.is_of_cable() {
            true => " of {cable}",
            false => "",
        };
        let first = self.parameters.first().map_or("", |p| p.name);
        let mut text = format!(
            "id = \"{id}\"\ntitle = \"{id}\"\nscope = \"{}\"\n\
             cause = \"{id}{of}: {{{first}}}.\"\nworkshop = \"Look at it.\"\n",
            self.scope
        );
        for parameter in &self.parameters {
            let [low, high] = parameter.typical;
            let role = match parameter.is_phase {
                true => "role = \"phase\"\n",
                false => "",
            };
            // Writing to a string cannot fail.
            let _ = write!(
                text,
                "\n[parameters.{}]\nunit = \"{}\"\ntypical = [{low:e}, {high:e}]\n{role}",
                parameter.name, parameter.unit
            );
        }
        text.push_str("\n[change]\n");
        for (target, formula) in &self.change {
            let _ = writeln!(text, "{target} = \"{formula}\"");
        }
        text
    }
}

/// An effect outside the catalogue as a file, or why the language cannot express it on this robot. The engineer knows the
/// scene: where the obstacle is, which cable pulls at the compass.
///
/// # Errors
/// The reason why it cannot be written.
pub fn of_outside(id: &str, scene: &Scene, data: &Measurements) -> Result<File, &'static str> {
    let robot = &scene.truth;
    Ok(match id {
        "curved_target" => of_curve("laser_bias", robot, data),
        "laser_incidence" => {
            let tilt = match is_planar(robot) {
                true => "rotation_z ^ 2",
                false => "(rotation_x ^ 2 + rotation_y ^ 2)",
            };
            File::new("robot", "laser_bias", format!("laser_bias + size * {tilt}")).with(
                "size",
                "m/rad^2",
                [1e-2, 1.0],
            )
        }
        "laser_hum" => of_time("robot", "laser_bias", 350.0).with("amplitude", "m", LENGTH_M),
        "thermal_cycle" => {
            let wave = "sin(2 * pi * time / 400 [s] + phase) - sin(phase)";
            File::new("cable", "paid", format!("paid + amplitude * ({wave})"))
                .with("amplitude", "m", LENGTH_M)
                .with_phase()
        }
        "gear_ripple" => {
            let wave = "sin(2 * pi * 3.37 * drum_revolutions + phase) - sin(phase)";
            File::new("cable", "paid", format!("paid + amplitude * ({wave})"))
                .with("amplitude", "m", LENGTH_M)
                .with_phase()
        }
        "guide_eyelet" => of_eyelet(robot)?,
        "soft_bracket" => of_bracket(scene, data),
        "frame_sway" => of_sway(robot, data)?,
        "obstacle" => of_obstacle(scene, data),
        "force_square" => {
            let sd = load_sd_n(scene.cable, data);
            let size = TENSION_N.map(|error| error / sd.powi(2));
            let change = "tension + size * (tension - mean_tension) ^ 2";
            File::new("cable", "tension", change).with("size", "1/N", size)
        }
        "force_saturation" => {
            let change = "tension + size * max(tension - mean_tension, 0 [N])";
            File::new("cable", "tension", change).with("size", "1", [1e-2, 0.5])
        }
        "force_wander" => of_time("robot", "tension", 700.0).with("amplitude", "N", TENSION_N),
        "force_crosstalk" => {
            let change = "tension + size * (tension_of(next) - mean_tension_of(next))";
            File::new("cable", "tension", change).with("size", "1", [1e-2, 0.5])
        }
        "loaded_compass" => {
            let size = ANGLE_RAD.map(|angle| angle / load_sd_n(scene.cable, data));
            let cable = scene.cable + 1;
            let load = format!("(tension_of({cable}) - mean_tension_of({cable}))");
            let change = format!("yaw_offset + size * {load}");
            File::new("robot", "yaw_offset", change).with("size", "rad/N", size)
        }
        "refraction" => of_curve("tracker_shift_z", robot, data),
        "swivel_wander" => {
            of_time("cable", "swivel_offset", 500.0).with("amplitude", "rad", ANGLE_RAD)
        }
        _ => return Err("there is no such effect"),
    })
}

fn is_planar(robot: &Robot) -> bool {
    robot.platform.free.len() < 6
}

/// A wave in time without value at home, where no reading is relative.
fn of_time(scope: &'static str, target: &'static str, period_s: f64) -> File {
    let wave = format!("sin(2 * pi * time / {period_s} [s] + phase)");
    File::new(scope, target, format!("{target} + amplitude * {wave}")).with_phase()
}

/// Mean and largest excursion of the positions (m).
fn spread(data: &Measurements) -> (Vec3, f64) {
    let positions = data.truth.poses.iter().map(|pose| pose.position);
    let mean = positions.clone().sum::<Vec3>() / data.len() as f64;
    let largest = positions.map(|position| (position - mean).amax());
    (mean, largest.fold(1e-9, f64::max))
}

/// A coordinate relative to a place.
fn from(axis: &str, place: f64) -> String {
    let sign = if place < 0.0 { '+' } else { '-' };
    format!("(position_{axis} {sign} {:.4} [m])", place.abs())
}

/// An error quadratic in the horizontal position, in whichever direction.
fn of_curve(target: &'static str, robot: &Robot, data: &Measurements) -> File {
    let (mean, largest) = spread(data);
    let [x, y] = [from("x", mean.x), from("y", mean.y)];
    let size = LENGTH_M.map(|error| error / largest.powi(2));
    if is_planar(robot) {
        let change = format!("{target} + size * {x} ^ 2");
        return File::new("robot", target, change).with("size", "1/m", size);
    }
    let change = format!("{target} + along_x * {x} ^ 2 + across * {x} * {y} + along_y * {y} ^ 2");
    ["along_x", "across", "along_y"]
        .into_iter()
        .fold(File::new("robot", target, change), |file, name| {
            file.with(name, "1/m", size)
        })
}

fn of_eyelet(robot: &Robot) -> Result<File, &'static str> {
    if is_planar(robot) {
        return Err("no quantity is the direction of a cable in a vertical plane");
    }
    let angle = "3 * atan2(pull_y, pull_x)";
    let wave = format!("sine * sin({angle}) + cosine * cos({angle}) + at_start");
    let change = format!("paid + ({wave}) * (1 - at_home)");
    let file = File::new("cable", "paid", change);
    Ok(["sine", "cosine", "at_start"]
        .into_iter()
        .fold(file, |file, name| file.with(name, "m", LENGTH_M)))
}

/// The anchor yields sideways with the load.
fn of_bracket(scene: &Scene, data: &Measurements) -> File {
    let size = LENGTH_M.map(|error| error / load_sd_n(scene.cable, data));
    let change = |axis: &str| format!("anchor_{axis} + along_{axis} * (tension - mean_tension)");
    let file = File::new("cable", "anchor_x", change("x")).with("along_x", "m/N", size);
    match is_planar(&scene.truth) {
        true => file,
        false => file
            .and("anchor_y", change("y"))
            .with("along_y", "m/N", size),
    }
}

/// Every second pulley sways: those at two opposite corners of the frame.
fn of_sway(robot: &Robot, data: &Measurements) -> Result<File, &'static str> {
    let is_at_corner =
        |(index, entry): (usize, [f64; 3])| (index % 2 == 0) == (entry[0] * entry[1] < 0.0);
    let entries = robot.cables.iter().map(|cable| cable.pulley.entry_point_m);
    if !entries.enumerate().all(is_at_corner) {
        return Err("no quantity tells every second cable from the others");
    }
    let last = data.time_s.last().copied().unwrap_or(1.0).max(1.0);
    let sways = format!("(1 - sign(entry_x * entry_y)) / 2 * time / {last} [s]");
    let angle = "2 * pi * time / 170 [s]";
    let change = |axis: &str| {
        format!(
            "entry_shift_{axis} + {sways} * (sine_{axis} * sin({angle}) + cosine_{axis} * cos({angle}))"
        )
    };
    let file = File::new("cable_or_all", "entry_shift_x", change("x"))
        .with("sine_x", "m", LENGTH_M)
        .with("cosine_x", "m", LENGTH_M);
    Ok(match is_planar(robot) {
        true => file,
        false => file
            .and("entry_shift_y", change("y"))
            .with("sine_y", "m", LENGTH_M)
            .with("cosine_y", "m", LENGTH_M),
    })
}

/// A cable rubs where the platform is near a place that the engineer has seen.
fn of_obstacle(scene: &Scene, data: &Measurements) -> File {
    let (mean, largest) = spread(data);
    let corner = mean + scene.direction * (0.6 * largest);
    let width = 0.35 * largest;
    let square = ["x", "y", "z"]
        .iter()
        .zip(corner.iter())
        .map(|(axis, place)| format!("{} ^ 2", from(axis, *place)))
        .collect::<Vec<_>>()
        .join(" + ");
    let home = data.home_row().and(scene.truth.home.as_ref());
    let at_home = home.map_or(0.0, |home| {
        let distance = (Vec3::from(home.position_m) - corner).norm();
        (-0.5 * (distance / width).powi(2)).exp()
    });
    let rub = format!(
        "exp(-0.5 * ({square}) / {:.6} [m^2]) - {at_home:.6}",
        width.powi(2)
    );
    File::new("cable", "paid", format!("paid + size * ({rub})")).with("size", "m", LENGTH_M)
}

/// Standard deviation of the tension of a cable (N).
fn load_sd_n(cable: usize, data: &Measurements) -> f64 {
    let loads: Vec<f64> = (0..data.truth.tension_n.rows())
        .map(|row| data.truth.tension_n.get(row, cable))
        .collect();
    let count = loads.len().max(1) as f64;
    let mean = loads.iter().sum::<f64>() / count;
    let variance = loads.iter().map(|load| (load - mean).powi(2)).sum::<f64>() / count;
    variance.sqrt().max(1e-9)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tables::hidden::{Conditions, OUTSIDE, Setup, robots};
    use tautline_core::effect::Hypothesis;

    #[test]
    fn every_effect_outside_the_catalogue_can_be_written_on_some_robot() {
        for effect in &OUTSIDE {
            let mut written = 0;
            for robot in robots() {
                if !(effect.applies)(&robot.preset.robot) {
                    continue;
                }
                let setup = Setup {
                    robot,
                    seed: 2,
                    conditions: Conditions::default(),
                };
                let exact = setup.exact(&[]).unwrap();
                let scene = Scene::new(&exact.truth, setup.seed);
                if let Ok(file) = of_outside(effect.id, &scene, &exact.dataset.measurements) {
                    let text = file.text(effect.id);
                    Hypothesis::parse(&text).unwrap_or_else(|error| panic!("{error}\n{text}"));
                    written += 1;
                }
            }
            assert!(written > 0, "{}", effect.id);
        }
    }
}

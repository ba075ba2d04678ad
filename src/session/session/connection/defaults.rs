//! The names that a controller uses whose engineer took over the sample program of `docs/ADS.md`.

use tautline_core::robot::Robot;

use super::{
    AdsCommand, AdsMapping, AdsNames, AdsParameter, AdsPose, AdsReadings, AdsRotation, AdsStatus,
    AdsSymbol, AdsSymbols,
};

const AXES: [&str; 3] = ["x", "y", "z"];

impl AdsMapping {
    /// The mapping that fits the sample program, for the instruments that a robot has.
    #[must_use]
    pub fn default_for(robot: &Robot) -> Self {
        let swivels = robot
            .cables
            .iter()
            .any(|cable| cable.pulley.swivel_sd_rad.is_some());
        Self {
            readings: AdsReadings {
                revolutions: array("revolutions"),
                force: robot.has_force_sensors().then(|| array("force")),
                swivel: swivels.then(|| array("swivel")),
                laser: robot.laser.map(|_| value("laser")),
                laser_valid: robot.laser.map(|_| global("laser_valid")),
                temperature: Some(value("temperature")),
                time: Some(value("time")),
                inclination: robot.inclinometer.map(|_| array("inclination")),
                pose: Some(pose("pose")),
            },
            state: AdsStatus {
                moving: Some(global("moving")),
                fault: Some(global("fault")),
                fault_text: Some(global("fault_text")),
                started: Some(global("started")),
            },
            command: Some(AdsCommand {
                target: pose("target"),
                kind: global("kind"),
                number: global("number"),
                acknowledged: global("acknowledged"),
            }),
            release: Some(global("release")),
            watchdog: Some(global("watchdog")),
            parameters: parameters(robot),
        }
    }
}

fn parameters(robot: &Robot) -> Vec<AdsParameter> {
    let mut list = Vec::new();
    for part in ["entry_point", "platform_anchor"] {
        for (element, axis) in (0..).zip(AXES) {
            let name = format!("{{cable}}.{part}.{axis}_m");
            list.push(parameter(name, part, (element, 3)));
        }
    }
    let radius = "{cable}.pulley.radius_m".to_owned();
    list.push(parameter(radius, "pulley_radius", (0, 1)));
    let drum = "{cable}.winch.drum_diameter_m".to_owned();
    list.push(parameter(drum, "drum_diameter", (0, 1)));
    if robot.home.is_some() {
        let position = AXES.map(|axis| format!("home.{axis}_m"));
        let rotation = AXES.map(|axis| format!("home.r{axis}_rad"));
        for (element, name) in (0..).zip(position.into_iter().chain(rotation)) {
            list.push(parameter(name, "home", (element, 1)));
        }
    }
    if robot.laser.is_some() {
        let name = "laser.target_plane.offset_m".to_owned();
        list.push(parameter(name, "laser_plane_offset", (0, 1)));
    }
    list
}

fn parameter(name: String, symbol: &str, (element, stride): (u32, u32)) -> AdsParameter {
    AdsParameter {
        name,
        symbol: global(symbol),
        element,
        stride,
        scale: 1.0,
    }
}

fn global(name: &str) -> String {
    format!("GVL_Tautline.{name}")
}

fn array(name: &str) -> AdsSymbols {
    AdsSymbols {
        symbol: AdsNames::One(global(name)),
        scale: 1.0,
        offset: 0.0,
    }
}

fn value(name: &str) -> AdsSymbol {
    AdsSymbol {
        symbol: global(name),
        scale: 1.0,
        offset: 0.0,
    }
}

fn pose(name: &str) -> AdsPose {
    AdsPose {
        symbol: AdsNames::One(global(name)),
        rotation: AdsRotation::Quaternion,
        length_scale: 1.0,
        angle_scale: 1.0,
    }
}

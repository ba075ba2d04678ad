//! Default symbol names: those of a controller that uses the sample program of `docs/ADS.md`.

use tautline_core::robot::Robot;

use super::{
    SymbolCommand, SymbolList, SymbolMapping, SymbolNames, SymbolParameter, SymbolPose,
    SymbolReadings, SymbolRotation, SymbolStatus, SymbolValue,
};

/// Namespace of variables in TwinCAT's server.
const NAMESPACE: &str = "ns=4;s=";
const AXES: [&str; 3] = ["x", "y", "z"];

impl SymbolMapping {
    /// The mapping for the sample program, for the instruments of a robot.
    #[must_use]
    pub fn default_for(robot: &Robot) -> Self {
        let swivels = robot
            .cables
            .iter()
            .any(|cable| cable.pulley.swivel_sd_rad.is_some());
        Self {
            readings: SymbolReadings {
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
            state: SymbolStatus {
                moving: Some(global("moving")),
                fault: Some(global("fault")),
                fault_text: Some(global("fault_text")),
                started: Some(global("started")),
            },
            command: Some(SymbolCommand {
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

    /// The mapping for OPC UA: the nodes of TwinCAT's server for the sample program's variables.
    #[must_use]
    pub fn default_nodes_for(robot: &Robot) -> Self {
        let mut mapping = Self::default_for(robot);
        for name in mapping.names_mut() {
            name.insert_str(0, NAMESPACE);
        }
        mapping
    }

    /// The names of all symbols.
    pub fn names_mut(&mut self) -> Vec<&mut String> {
        let readings = &mut self.readings;
        let mut names = readings.revolutions.symbol.names_mut();
        for symbols in [
            &mut readings.force,
            &mut readings.swivel,
            &mut readings.inclination,
        ] {
            names.extend(symbols.iter_mut().flat_map(|list| list.symbol.names_mut()));
        }
        for value in [
            &mut readings.laser,
            &mut readings.temperature,
            &mut readings.time,
        ] {
            names.extend(value.iter_mut().map(|value| &mut value.symbol));
        }
        names.extend(readings.laser_valid.iter_mut());
        names.extend(
            readings
                .pose
                .iter_mut()
                .flat_map(|pose| pose.symbol.names_mut()),
        );
        let state = &mut self.state;
        for name in [
            &mut state.moving,
            &mut state.fault,
            &mut state.fault_text,
            &mut state.started,
            &mut self.release,
            &mut self.watchdog,
        ] {
            names.extend(name.iter_mut());
        }
        if let Some(command) = &mut self.command {
            names.extend(command.target.symbol.names_mut());
            names.extend([
                &mut command.kind,
                &mut command.number,
                &mut command.acknowledged,
            ]);
        }
        names.extend(
            self.parameters
                .iter_mut()
                .map(|parameter| &mut parameter.symbol),
        );
        names
    }
}

impl SymbolNames {
    fn names_mut(&mut self) -> Vec<&mut String> {
        match self {
            Self::One(name) => vec![name],
            Self::Each(names) => names.iter_mut().collect(),
        }
    }
}

fn parameters(robot: &Robot) -> Vec<SymbolParameter> {
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

fn parameter(name: String, symbol: &str, (element, stride): (u32, u32)) -> SymbolParameter {
    SymbolParameter {
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

fn array(name: &str) -> SymbolList {
    SymbolList {
        symbol: SymbolNames::One(global(name)),
        scale: 1.0,
        offset: 0.0,
    }
}

fn value(name: &str) -> SymbolValue {
    SymbolValue {
        symbol: global(name),
        scale: 1.0,
        offset: 0.0,
    }
}

fn pose(name: &str) -> SymbolPose {
    SymbolPose {
        symbol: SymbolNames::One(global(name)),
        rotation: SymbolRotation::Quaternion,
        length_scale: 1.0,
        angle_scale: 1.0,
    }
}

//! Purposes of symbols, and their places in a mapping.

use tautline_session::{
    SymbolCommand, SymbolList, SymbolMapping, SymbolNames, SymbolPose, SymbolValue,
};

/// Purpose of a symbol.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SymbolRole {
    Revolutions,
    Force,
    Swivel,
    Laser,
    LaserValid,
    Temperature,
    Time,
    Inclination,
    Pose,
    Moving,
    Fault,
    FaultText,
    Target,
    Kind,
    Number,
    Acknowledged,
    Release,
    Watchdog,
    /// Parameter, by its index in the mapping.
    Parameter(usize),
}

impl SymbolRole {
    /// All purposes except parameters, with their title and the unit for a scale of 1.
    pub const FIXED: [(Self, &'static str, &'static str); 18] = [
        (Self::Revolutions, "Motor revolutions", "revolutions"),
        (Self::Force, "Force readings", "N"),
        (Self::Swivel, "Swivel angles", "rad"),
        (Self::Laser, "Laser distance", "m"),
        (Self::LaserValid, "Laser has a return", ""),
        (Self::Temperature, "Temperature", "°C"),
        (Self::Time, "Time", "s"),
        (Self::Inclination, "Roll, pitch and yaw", "rad"),
        (Self::Pose, "Commanded pose", "m"),
        (Self::Moving, "Platform is moving", ""),
        (Self::Fault, "Fault", ""),
        (Self::FaultText, "Fault text", ""),
        (Self::Target, "Target pose", "m"),
        (Self::Kind, "Command type", ""),
        (Self::Number, "Command number", ""),
        (Self::Acknowledged, "Acknowledged number", ""),
        (Self::Release, "Release", ""),
        (Self::Watchdog, "Sample counter", ""),
    ];

    /// Whether the symbol has a scale: numbers do, which have a unit; texts and flags do not.
    pub fn has_scale(self) -> bool {
        let fixed = Self::FIXED.iter().find(|(role, ..)| *role == self);
        fixed.is_none_or(|(_, _, unit)| !unit.is_empty())
    }

    pub fn is_of_command(self) -> bool {
        matches!(
            self,
            Self::Target | Self::Kind | Self::Number | Self::Acknowledged
        )
    }
}

/// Command without symbols.
pub fn no_command() -> SymbolCommand {
    SymbolCommand {
        target: SymbolPose {
            symbol: SymbolNames::One(String::new()),
            rotation: Default::default(),
            length_scale: 1.0,
            angle_scale: 1.0,
        },
        kind: String::new(),
        number: String::new(),
        acknowledged: String::new(),
    }
}

fn text_of(names: &SymbolNames) -> String {
    match names {
        SymbolNames::One(name) => name.clone(),
        SymbolNames::Each(names) => names.join(", "),
    }
}

fn names_of(text: &str) -> SymbolNames {
    match text.contains(',') {
        true => SymbolNames::Each(text.split(',').map(|name| name.trim().to_owned()).collect()),
        false => SymbolNames::One(text.to_owned()),
    }
}

/// Name and scale of a purpose; empty if the mapping does not have it.
pub fn read(mapping: &SymbolMapping, need: SymbolRole) -> (String, Option<f64>) {
    let readings = &mapping.readings;
    let list = |s: &SymbolList| (text_of(&s.symbol), Some(s.scale));
    let lists = |s: &Option<SymbolList>| s.as_ref().map_or((String::new(), Some(1.0)), list);
    let value = |s: &Option<SymbolValue>| {
        let known = s.as_ref().map(|s| (s.symbol.clone(), Some(s.scale)));
        known.unwrap_or((String::new(), Some(1.0)))
    };
    let pose = |p: Option<&SymbolPose>| {
        let known = p.map(|p| (text_of(&p.symbol), Some(p.length_scale)));
        known.unwrap_or((String::new(), Some(1.0)))
    };
    let name = |s: &Option<String>| (s.clone().unwrap_or_default(), None);
    let command = mapping.command.as_ref();
    let told = |of: fn(&SymbolCommand) -> &String| {
        let name = command.map(of).cloned();
        (name.unwrap_or_default(), None)
    };
    match need {
        SymbolRole::Revolutions => list(&readings.revolutions),
        SymbolRole::Force => lists(&readings.force),
        SymbolRole::Swivel => lists(&readings.swivel),
        SymbolRole::Laser => value(&readings.laser),
        SymbolRole::LaserValid => name(&readings.laser_valid),
        SymbolRole::Temperature => value(&readings.temperature),
        SymbolRole::Time => value(&readings.time),
        SymbolRole::Inclination => lists(&readings.inclination),
        SymbolRole::Pose => pose(readings.pose.as_ref()),
        SymbolRole::Moving => name(&mapping.state.moving),
        SymbolRole::Fault => name(&mapping.state.fault),
        SymbolRole::FaultText => name(&mapping.state.fault_text),
        SymbolRole::Target => pose(command.map(|c| &c.target)),
        SymbolRole::Kind => told(|c| &c.kind),
        SymbolRole::Number => told(|c| &c.number),
        SymbolRole::Acknowledged => told(|c| &c.acknowledged),
        SymbolRole::Release => name(&mapping.release),
        SymbolRole::Watchdog => name(&mapping.watchdog),
        SymbolRole::Parameter(_) => (String::new(), None),
    }
}

/// Writes name and scale of a purpose into a mapping; the error names a missing part.
pub fn write(
    mapping: &mut SymbolMapping,
    need: SymbolRole,
    symbol: &str,
    scale: f64,
) -> Result<(), String> {
    let text = symbol.trim();
    let wanted = !text.is_empty();
    let missing = || Err("found nothing, expected the name of a symbol".to_owned());
    let list = |old: &Option<SymbolList>| {
        wanted.then(|| SymbolList {
            symbol: names_of(text),
            scale,
            offset: old.as_ref().map_or(0.0, |old| old.offset),
        })
    };
    let value = |old: &Option<SymbolValue>| {
        wanted.then(|| SymbolValue {
            symbol: text.to_owned(),
            scale,
            offset: old.as_ref().map_or(0.0, |old| old.offset),
        })
    };
    let pose = |old: Option<&SymbolPose>| SymbolPose {
        symbol: names_of(text),
        length_scale: scale,
        rotation: old.map_or_else(Default::default, |old| old.rotation),
        angle_scale: old.map_or(1.0, |old| old.angle_scale),
    };
    let name = || wanted.then(|| text.to_owned());
    let readings = &mut mapping.readings;
    match need {
        SymbolRole::Revolutions if !wanted => return missing(),
        SymbolRole::Revolutions => {
            readings.revolutions.symbol = names_of(text);
            readings.revolutions.scale = scale;
        }
        SymbolRole::Force => readings.force = list(&readings.force),
        SymbolRole::Swivel => readings.swivel = list(&readings.swivel),
        SymbolRole::Laser => readings.laser = value(&readings.laser),
        SymbolRole::LaserValid => readings.laser_valid = name(),
        SymbolRole::Temperature => readings.temperature = value(&readings.temperature),
        SymbolRole::Time => readings.time = value(&readings.time),
        SymbolRole::Inclination => readings.inclination = list(&readings.inclination),
        SymbolRole::Pose => readings.pose = wanted.then(|| pose(readings.pose.as_ref())),
        SymbolRole::Moving => mapping.state.moving = name(),
        SymbolRole::Fault => mapping.state.fault = name(),
        SymbolRole::FaultText => mapping.state.fault_text = name(),
        SymbolRole::Release => mapping.release = name(),
        SymbolRole::Watchdog => mapping.watchdog = name(),
        SymbolRole::Target | SymbolRole::Kind | SymbolRole::Number | SymbolRole::Acknowledged => {
            let Some(command) = &mut mapping.command else {
                return Ok(());
            };
            if !wanted {
                return missing();
            }
            match need {
                SymbolRole::Target => command.target = pose(Some(&command.target)),
                SymbolRole::Kind => command.kind = text.to_owned(),
                SymbolRole::Number => command.number = text.to_owned(),
                _ => command.acknowledged = text.to_owned(),
            }
        }
        SymbolRole::Parameter(k) => {
            if let Some(parameter) = mapping.parameters.get_mut(k) {
                parameter.symbol = text.to_owned();
                parameter.scale = scale;
            }
        }
    }
    Ok(())
}

/// Title of a parameter: "{cable}.entry_point.x_m" is "Entry point x of every cable".
pub fn title_of(name: &str) -> String {
    let (whose, rest) = match name.strip_prefix("{cable}.") {
        Some(rest) => (" of every cable", rest),
        None => ("", name),
    };
    let plain = ["_rad", "_mm", "_m", "_n"]
        .iter()
        .find_map(|unit| rest.strip_suffix(unit));
    let words = plain.unwrap_or(rest).replace(['.', '_'], " ");
    tautline_workflow::wording::sentence(&format!("{words}{whose}"))
}

/// Unit at the end of a parameter's name.
pub fn unit_of(name: &str) -> &'static str {
    match name.rsplit('_').next() {
        Some("m") => "m",
        Some("rad") => "rad",
        _ => "",
    }
}

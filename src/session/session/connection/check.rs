//! Checks of connection settings.

use std::collections::HashSet;

use tautline_core::robot::{FieldError, Robot};

use super::{
    CABLE, Connection, ControllerKind, NUMBER, SymbolList, SymbolMapping, SymbolNames,
    SymbolParameter, SymbolPose, SymbolReadings, SymbolValue, is_per_cable, name_of_cable,
};
use crate::error::{below, fail};
use crate::json::VersionedFile;

type Checked = Result<(), FieldError>;

/// Longest symbol name of a controller (characters).
const LONGEST: usize = 255;

/// Checks that symbols have names, scales are invertible, and every cable has its symbol.
pub(in crate::session) fn check(connection: &Connection, robot: &Robot) -> Checked {
    let part = |name: &'static str| {
        let at = format!("/connection/{name}");
        move |error| below(&at, error)
    };
    let missing = |part: &str| {
        let message = "found nothing, expected the address of the controller";
        fail(format!("/connection/{part}"), message)
    };
    match &connection.recording {
        Some(place) => place.check().map_err(part("recording"))?,
        None if connection.controller == ControllerKind::Recording => return missing("recording"),
        None => {}
    }
    match &connection.place {
        Some(place) => place.check().map_err(part("place"))?,
        None if connection.controller == ControllerKind::Ads => return missing("place"),
        None => {}
    }
    match &connection.opcua {
        Some(place) => place.check().map_err(part("opcua"))?,
        None if connection.controller == ControllerKind::OpcUa => return missing("opcua"),
        None => {}
    }
    for (name, mapping) in [("ads", &connection.ads), ("nodes", &connection.nodes)] {
        let checked = mapping
            .as_ref()
            .map_or(Ok(()), |mapping| mapping.check(robot));
        checked.map_err(part(name))?;
    }
    Ok(())
}

impl VersionedFile for SymbolMapping {
    const FORMAT: &'static str = "tautline-symbols";
    const VERSION: u32 = 1;
    const MAX_BYTES: u64 = 4 << 20;
}

impl SymbolMapping {
    /// Checks the mapping for a robot; pointers in errors are relative to the mapping.
    ///
    /// # Errors
    /// The first invalid field.
    pub fn check(&self, robot: &Robot) -> Checked {
        readings(&self.readings, robot)?;
        let state = &self.state;
        for (key, symbol) in [
            ("/state/moving", &state.moving),
            ("/state/fault", &state.fault),
            ("/state/fault_text", &state.fault_text),
            ("/state/started", &state.started),
            ("/release", &self.release),
            ("/watchdog", &self.watchdog),
        ] {
            symbol.as_ref().map_or(Ok(()), |name| single(key, name))?;
        }
        if let Some(command) = &self.command {
            pose("/command/target", &command.target)?;
            single("/command/kind", &command.kind)?;
            single("/command/number", &command.number)?;
            single("/command/acknowledged", &command.acknowledged)?;
            if state.moving.is_none() {
                let message = "found no symbol, expected one: a controller that takes commands has to report when it moves";
                return fail("/state/moving", message);
            }
        }
        parameters(&self.parameters, robot)
    }
}

fn readings(readings: &SymbolReadings, robot: &Robot) -> Checked {
    let cables = robot.cable_count();
    let per_cable = [
        ("/readings/revolutions", Some(&readings.revolutions)),
        ("/readings/force", readings.force.as_ref()),
        ("/readings/swivel", readings.swivel.as_ref()),
    ];
    for (at, symbols) in per_cable {
        let Some(symbols) = symbols else { continue };
        factor(&format!("{at}/scale"), symbols.scale)?;
        finite(&format!("{at}/offset"), symbols.offset)?;
        match &symbols.symbol {
            SymbolNames::One(name) if name.contains('{') => placed(&format!("{at}/symbol"), name)?,
            names => listed(&format!("{at}/symbol"), names, cables)?,
        }
    }
    let numbers = [
        ("/readings/laser", &readings.laser),
        ("/readings/temperature", &readings.temperature),
        ("/readings/time", &readings.time),
    ];
    for (at, symbol) in numbers {
        symbol.as_ref().map_or(Ok(()), |s| number(at, s))?;
    }
    if let Some(name) = &readings.laser_valid {
        single("/readings/laser_valid", name)?;
    }
    if let Some(angles) = &readings.inclination {
        three("/readings/inclination", angles)?;
    }
    (readings.pose.as_ref()).map_or(Ok(()), |p| pose("/readings/pose", p))
}

fn number(at: &str, symbol: &SymbolValue) -> Checked {
    single(&format!("{at}/symbol"), &symbol.symbol)?;
    factor(&format!("{at}/scale"), symbol.scale)?;
    finite(&format!("{at}/offset"), symbol.offset)
}

fn three(at: &str, symbols: &SymbolList) -> Checked {
    listed(&format!("{at}/symbol"), &symbols.symbol, 3)?;
    factor(&format!("{at}/scale"), symbols.scale)?;
    finite(&format!("{at}/offset"), symbols.offset)
}

fn pose(at: &str, pose: &SymbolPose) -> Checked {
    listed(
        &format!("{at}/symbol"),
        &pose.symbol,
        pose.rotation.pose_values(),
    )?;
    factor(&format!("{at}/length_scale"), pose.length_scale)?;
    factor(&format!("{at}/angle_scale"), pose.angle_scale)
}

/// An array, or a list of the right length.
fn listed(at: &str, names: &SymbolNames, count: usize) -> Checked {
    match names {
        SymbolNames::One(name) => single(at, name),
        SymbolNames::Each(names) if names.len() != count => {
            let message = format!("found {} names, expected {count}", names.len());
            fail(at, message)
        }
        SymbolNames::Each(names) => {
            let mut numbered = names.iter().enumerate();
            numbered.try_for_each(|(k, name)| single(&format!("{at}/{k}"), name))
        }
    }
}

/// The name of one symbol.
fn single(at: &str, name: &str) -> Checked {
    // Node identifiers may contain blanks and letters of any language.
    let strange = |c: char| match is_node(name) {
        true => c.is_control() || c == '{' || c == '}',
        false => !c.is_ascii_graphic() || c == '{' || c == '}',
    };
    if name.is_empty() || name.len() > LONGEST || name.contains(strange) {
        let message =
            format!("found {name:?}, expected the name of a symbol, like GVL_Tautline.moving");
        return fail(at, message);
    }
    Ok(())
}

/// Whether a name is an OPC UA node identifier, such as `ns=4;s=GVL_Tautline.moving` or `i=2257`.
fn is_node(name: &str) -> bool {
    let (first, rest) = name.split_once(';').unwrap_or((name, ""));
    let kind = if first.starts_with("ns=") {
        rest
    } else {
        first
    };
    ["s=", "i=", "g=", "b="]
        .iter()
        .any(|known| kind.starts_with(known))
}

/// Checks a name pattern with one symbol per cable: apart from the placeholder it must be a valid symbol name.
fn placed(at: &str, pattern: &str) -> Checked {
    let rest = pattern.replace(CABLE, "c").replace(NUMBER, "1");
    if single(at, &rest).is_err() {
        let message = format!(
            "found {pattern:?}, expected the name of a symbol, in which {CABLE} is the cable's name and {NUMBER} its number"
        );
        return fail(at, message);
    }
    Ok(())
}

fn parameters(list: &[SymbolParameter], robot: &Robot) -> Checked {
    let mut names = HashSet::new();
    for (k, parameter) in list.iter().enumerate() {
        let at = format!("/parameters/{k}");
        self::parameter(&at, parameter)?;
        let cables = robot.cables.iter().enumerate();
        let expanded: Vec<String> = match is_per_cable(&parameter.name) {
            true => cables
                .map(|(c, cable)| name_of_cable(&parameter.name, &cable.name, c))
                .collect(),
            false => vec![parameter.name.clone()],
        };
        for name in expanded {
            if names.contains(&name) {
                let message = format!("found {name:?} again, expected each name once");
                return fail(format!("{at}/name"), message);
            }
            names.insert(name);
        }
    }
    Ok(())
}

fn parameter(at: &str, parameter: &SymbolParameter) -> Checked {
    factor(&format!("{at}/scale"), parameter.scale)?;
    placed(&format!("{at}/symbol"), &parameter.symbol)?;
    if parameter.name.trim().is_empty() {
        return fail(format!("{at}/name"), "found an empty text, expected a name");
    }
    let each = is_per_cable(&parameter.name);
    if !each && is_per_cable(&parameter.symbol) {
        let message = format!(
            "found {:?}, expected {CABLE} in it, because the symbol is one per cable",
            parameter.name
        );
        return fail(format!("{at}/name"), message);
    }
    if each && parameter.stride == 0 {
        let message = "found 0, expected at least 1: every cable has its own element";
        return fail(format!("{at}/stride"), message);
    }
    Ok(())
}

fn factor(at: &str, value: f64) -> Checked {
    if value.is_finite() && value != 0.0 {
        return Ok(());
    }
    let message = format!("found {value}, expected a finite number that is not 0");
    fail(at, message)
}

fn finite(at: &str, value: f64) -> Checked {
    if value.is_finite() {
        return Ok(());
    }
    let message = format!("found {value}, expected a finite number");
    fail(at, message)
}

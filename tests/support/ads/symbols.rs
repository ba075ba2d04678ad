//! Symbols of the controller in two layouts: arrays, and one symbol for each value.

use serde_json::{Value, json};
use tautline_core::robot::Robot;
use tautline_link::parameters::parameters_of;
use tautline_session::{SymbolMapping, SymbolNames, SymbolParameter};

/// The layout of the symbols.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Style {
    /// That of the sample program in docs/ADS.md.
    Arrays,
    /// One symbol per value and cable, in millimetres, with motors that count backwards.
    Single,
}

/// The symbol, or element of an array, in which the controller keeps a parameter.
#[derive(Debug)]
pub struct ParameterElement {
    /// The symbol.
    pub symbol: String,
    /// The element, if the symbol is an array.
    pub element: usize,
    /// The name of the parameter.
    pub name: String,
    /// SI units per unit of the symbol.
    pub scale: f64,
}

/// Scale and offset from a symbol of [`Style::Single`] to motor revolutions.
pub const TURNS: (f64, f64) = (-0.5, 3.0);

/// The symbol of a global variable of the sample program.
#[must_use]
pub fn global(name: &str) -> String {
    format!("GVL_Tautline.{name}")
}

/// The mapping by which a client finds the symbols.
#[must_use]
pub fn mapping(robot: &Robot, style: Style) -> SymbolMapping {
    let mut mapping = SymbolMapping::default_for(robot);
    if style == Style::Arrays {
        return mapping;
    }
    mapping.readings.revolutions.symbol = SymbolNames::One("Winch[{n}].turns".into());
    (
        mapping.readings.revolutions.scale,
        mapping.readings.revolutions.offset,
    ) = TURNS;
    if let Some(force) = &mut mapping.readings.force {
        let names = (1..=robot.cable_count()).map(|n| format!("Force{n}"));
        force.symbol = SymbolNames::Each(names.collect());
    }
    for parameter in &mut mapping.parameters {
        *parameter = SymbolParameter {
            symbol: parameter.name.replace("{cable}.", "Winch[{n}]."),
            element: 0,
            stride: 1,
            scale: 1e-3,
            ..parameter.clone()
        };
    }
    mapping
}

/// Symbols of the parameters of the robot, in the order of [`parameters_of`].
#[must_use]
pub fn places(robot: &Robot, style: Style) -> Vec<ParameterElement> {
    let place = |name: &String| {
        let cable = robot
            .cables
            .iter()
            .position(|c| name.starts_with(&format!("{}.", c.name)));
        let (symbol, element) = match (style, cable) {
            (Style::Single, Some(k)) => {
                let cable = format!("{}.", robot.cables[k].name);
                (name.replace(&cable, &format!("Winch[{}].", k + 1)), 0)
            }
            (Style::Single, None) => (name.clone(), 0),
            (Style::Arrays, cable) => array_place(name, cable.unwrap_or(0)),
        };
        let scale = if style == Style::Single { 1e-3 } else { 1.0 };
        let name = name.clone();
        ParameterElement {
            symbol,
            element,
            name,
            scale,
        }
    };
    parameters_of(robot)
        .iter()
        .map(|p| place(&p.name))
        .collect()
}

fn array_place(name: &str, cable: usize) -> (String, usize) {
    let axis = |of: &str| {
        ["x", "y", "z"]
            .iter()
            .position(|a| of.starts_with(a))
            .unwrap_or(0)
    };
    for (part, symbol) in [
        (".entry_point.", "entry_point"),
        (".platform_anchor.", "platform_anchor"),
    ] {
        if let Some((_, rest)) = name.split_once(part) {
            return (global(symbol), 3 * cable + axis(rest));
        }
    }
    match name.strip_prefix("home.") {
        Some(rest) => match rest.strip_prefix('r') {
            Some(rest) => (global("home"), 3 + axis(rest)),
            None => (global("home"), axis(rest)),
        },
        None if name.ends_with("pulley.radius_m") => (global("pulley_radius"), cable),
        None if name.ends_with("drum_diameter_m") => (global("drum_diameter"), cable),
        None => (global("laser_plane_offset"), 0),
    }
}

/// Declarations of all symbols: name, type, number of elements, values.
#[must_use]
pub fn declarations(robot: &Robot, style: Style) -> Vec<Value> {
    let cables = robot.cable_count();
    let mut list = vec![
        json!([global("laser"), "LREAL", 1, [0.0]]),
        json!([global("laser_valid"), "BOOL", 1, [false]]),
        json!([global("temperature"), "LREAL", 1, [20.0]]),
        json!([global("time"), "LREAL", 1, [0.0]]),
        json!([global("pose"), "LREAL", 7, [0, 0, 0, 1, 0, 0, 0]]),
        json!([global("target"), "LREAL", 7, [0, 0, 0, 1, 0, 0, 0]]),
        json!([global("moving"), "BOOL", 1, [false]]),
        json!([global("fault"), "UDINT", 1, [0]]),
        json!([global("fault_text"), "STRING", 1, [""]]),
        json!([global("kind"), "INT", 1, [0]]),
        json!([global("number"), "UDINT", 1, [7]]),
        json!([global("acknowledged"), "UDINT", 1, [7]]),
        json!([global("release"), "BOOL", 1, [false]]),
        json!([global("watchdog"), "UDINT", 1, [0]]),
        json!([global("started"), "LREAL", 1, [0.0]]),
        json!([global("shown"), "LREAL", 1, [0.0]]),
    ];
    let zeros = vec![0.0; cables];
    match style {
        Style::Arrays => {
            list.push(json!([global("revolutions"), "LREAL", cables, zeros]));
            list.push(json!([global("force"), "REAL", cables, zeros]));
        }
        Style::Single => {
            for n in 1..=cables {
                list.push(json!([format!("Winch[{n}].turns"), "LREAL", 1, [0.0]]));
                list.push(json!([format!("Force{n}"), "REAL", 1, [0.0]]));
            }
        }
    }
    list.extend(parameters(robot, style));
    list
}

fn parameters(robot: &Robot, style: Style) -> Vec<Value> {
    let values = parameters_of(robot);
    let mut symbols: Vec<(String, Vec<f64>)> = Vec::new();
    for (place, parameter) in places(robot, style).into_iter().zip(values) {
        let known = symbols.iter().position(|(name, _)| *name == place.symbol);
        let index = known.unwrap_or_else(|| {
            symbols.push((place.symbol.clone(), Vec::new()));
            symbols.len() - 1
        });
        let numbers = &mut symbols[index].1;
        numbers.resize(numbers.len().max(place.element + 1), 0.0);
        numbers[place.element] = parameter.value / place.scale;
    }
    let symbols = symbols.into_iter();
    symbols
        .map(|(name, values)| json!([name, "LREAL", values.len(), values]))
        .collect()
}

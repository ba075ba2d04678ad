//! Names, units and values of the robot parameters in a controller.
//!
//! | name | what |
//! |---|---|
//! | `CABLE.entry_point.x_m`, `.y_m`, `.z_m` | entry point, base frame |
//! | `CABLE.platform_anchor.x_m`, `.y_m`, `.z_m` | anchor, platform frame |
//! | `CABLE.pulley.radius_m` | pulley radius |
//! | `CABLE.winch.drum_diameter_m` | drum diameter |
//! | `CABLE.home.length_m` | length from entry point to anchor at home, pulley included |
//! | `home.x_m`, `.y_m`, `.z_m`, `.rx_rad`, `.ry_rad`, `.rz_rad` | home pose, its rotation as a vector |
//! | `laser.target_plane.offset_m` | offset of the laser's target plane |
//! | `effect.ID.PARAMETER`, `effect.ID.CABLE.PARAMETER` | an effect that the controller corrects; two cables joined by `+` |
//!
//! `CABLE` is the cable's name. A controller has the parameters it offers: home, laser and effects only if its
//! robot has them. Lengths at home follow from pose and geometry, so a robot description does not contain them; a
//! controller that stores them separately may have them.

use nalgebra::{UnitQuaternion, Vector3};
use tautline_core::effect::{EffectParameter, EffectSetting};
use tautline_core::kinematics::inverse_kinematics;
use tautline_core::robot::Robot;

use crate::error::LinkError;

/// One parameter and its value.
#[derive(Debug, Clone, PartialEq)]
pub struct ParameterInfo {
    /// Name, see the module documentation.
    pub name: String,
    /// SI unit; "1" for a ratio.
    pub unit: &'static str,
    /// Value.
    pub value: f64,
}

const AXES: [&str; 3] = ["x", "y", "z"];

/// All parameters of a robot with their values.
#[must_use]
pub fn parameters_of(robot: &Robot) -> Vec<ParameterInfo> {
    let mut list = Vec::new();
    let mut add = |name: String, unit, value| list.push(ParameterInfo { name, unit, value });
    for cable in &robot.cables {
        for (part, point) in [
            ("entry_point", cable.pulley.entry_point_m),
            ("platform_anchor", cable.platform_anchor_m),
        ] {
            for (axis, value) in AXES.iter().zip(point) {
                add(format!("{}.{part}.{axis}_m", cable.name), "m", value);
            }
        }
        add(
            format!("{}.pulley.radius_m", cable.name),
            "m",
            cable.pulley.radius_m,
        );
        let drum = cable.winch.drum_diameter_m;
        add(format!("{}.winch.drum_diameter_m", cable.name), "m", drum);
    }
    if let Some(home) = &robot.home {
        let rotation = home.pose().orientation.scaled_axis();
        for (axis, value) in AXES.iter().zip(home.position_m) {
            add(format!("home.{axis}_m"), "m", value);
        }
        for (axis, value) in AXES.iter().zip(rotation.iter()) {
            add(format!("home.r{axis}_rad"), "rad", *value);
        }
    }
    if let Some(laser) = &robot.laser {
        let name = "laser.target_plane.offset_m".to_owned();
        add(name, "m", laser.target_plane.offset_m);
    }
    for setting in &robot.effects {
        for parameter in robot
            .effect(&setting.effect)
            .map_or(&[][..], |e| e.parameters())
        {
            let value = setting.parameters.get(parameter.name).copied();
            add(
                effect_name(setting, parameter.name),
                parameter.unit,
                value.unwrap_or(parameter.neutral),
            );
        }
    }
    list
}

/// The lengths at home that follow from a robot's description: from the entry point over the pulley to the anchor (m).
/// Empty for a robot without a home pose, or if a cable has no path there.
#[must_use]
pub fn home_lengths(robot: &Robot) -> Vec<ParameterInfo> {
    let Some(home) = &robot.home else {
        return Vec::new();
    };
    let states = inverse_kinematics(robot, &home.pose()).unwrap_or_default();
    let cables = robot.cables.iter().zip(&states);
    cables
        .map(|(cable, state)| ParameterInfo {
            name: format!("{}.home.length_m", cable.name),
            unit: "m",
            value: state.length_m,
        })
        .collect()
}

/// All parameters of a robot and its lengths at home.
#[must_use]
pub fn parameters_and_home_lengths(robot: &Robot) -> Vec<ParameterInfo> {
    let mut list = parameters_of(robot);
    list.extend(home_lengths(robot));
    list
}

pub(crate) fn effect_name(setting: &EffectSetting, parameter: &str) -> String {
    let targets = setting.targets.join("+");
    let dot = if targets.is_empty() { "" } else { "." };
    format!("effect.{}{dot}{targets}.{parameter}", setting.effect)
}

/// Values of named parameters in a list.
pub(crate) fn values_of(
    parameters: &[ParameterInfo],
    names: &[String],
) -> Result<Vec<f64>, LinkError> {
    let value = |name: &String| {
        let known = parameters.iter().find(|p| p.name == *name);
        let unknown = || LinkError::UnknownParameter(name.clone());
        known.map(|p| p.value).ok_or_else(unknown)
    };
    names.iter().map(value).collect()
}

/// Parts of the name of an effect's parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct EffectName<'a> {
    /// Identifier of the effect.
    pub effect: &'a str,
    /// Name of the cable, or of two cables joined by `+`; empty for an effect without target.
    pub targets: &'a str,
    /// Name of the parameter.
    pub parameter: &'a str,
}

impl<'a> EffectName<'a> {
    /// Parses a name; `None` if it is not that of an effect's parameter.
    #[must_use]
    pub fn read(name: &'a str) -> Option<Self> {
        // A cable's name may contain dots; identifiers and names of parameters do not.
        let (effect, rest) = name.strip_prefix("effect.")?.split_once('.')?;
        let (targets, parameter) = rest.rsplit_once('.').unwrap_or(("", rest));
        Some(Self {
            effect,
            targets,
            parameter,
        })
    }

    /// Whether the name is that of a parameter of this effect on its targets.
    #[must_use]
    pub fn is_of(&self, setting: &EffectSetting) -> bool {
        self.effect == setting.effect && self.targets == setting.targets.join("+")
    }

    /// The parameter, if a robot could have this effect.
    #[must_use]
    pub fn parameter_of(&self, robot: &Robot) -> Option<&'static EffectParameter> {
        let mut all = robot.effect(self.effect)?.parameters().iter();
        all.find(|parameter| parameter.name == self.parameter)
    }
}

/// Rejects values that are not finite, which must never be written.
pub(crate) fn check_finite(values: &[(String, f64)]) -> Result<(), LinkError> {
    match values.iter().find(|(_, value)| !value.is_finite()) {
        None => Ok(()),
        Some((name, value)) => Err(LinkError::InvalidValue {
            name: name.clone(),
            value: *value,
            reason: NOT_FINITE.to_owned(),
        }),
    }
}

const NOT_FINITE: &str = "it is not a finite number";

/// Sets one parameter of a robot.
///
/// # Errors
/// If the robot has no such parameter, or it cannot have this value.
pub fn set_parameter(robot: &mut Robot, name: &str, value: f64) -> Result<(), LinkError> {
    let invalid = |reason: &str| {
        Err(LinkError::InvalidValue {
            name: name.to_owned(),
            value,
            reason: reason.to_owned(),
        })
    };
    if !value.is_finite() {
        return invalid(NOT_FINITE);
    }
    let Some(place) = place_of(robot, name) else {
        return Err(LinkError::UnknownParameter(name.to_owned()));
    };
    match place {
        ValueMut::Number(number) => *number = value,
        ValueMut::NotNegative(_) if value < 0.0 => return invalid("it is negative"),
        ValueMut::Positive(_) if value <= 0.0 => return invalid("it is not positive"),
        ValueMut::NotNegative(number) | ValueMut::Positive(number) => *number = value,
        ValueMut::HomeRotation(wxyz, axis) => {
            let [w, x, y, z] = *wxyz;
            let turn = nalgebra::Quaternion::new(w, x, y, z);
            let mut vector: Vector3<f64> = UnitQuaternion::from_quaternion(turn).scaled_axis();
            vector[axis] = value;
            let q = UnitQuaternion::from_scaled_axis(vector);
            *wxyz = [q.w, q.i, q.j, q.k];
        }
        ValueMut::Effect(setting, parameter) => {
            setting.parameters.insert(parameter, value);
        }
    }
    Ok(())
}

/// Reference to the value of a parameter in a robot.
enum ValueMut<'r> {
    Number(&'r mut f64),
    NotNegative(&'r mut f64),
    Positive(&'r mut f64),
    HomeRotation(&'r mut [f64; 4], usize),
    Effect(&'r mut EffectSetting, String),
}

fn place_of<'r>(robot: &'r mut Robot, name: &str) -> Option<ValueMut<'r>> {
    if let Some(rest) = name.strip_prefix("effect.") {
        return effect_place(robot, rest);
    }
    if let Some(rest) = name.strip_prefix("home.") {
        let home = robot.home.as_mut()?;
        if let Some(axis) = axis_of(rest, "_m") {
            return home.position_m.get_mut(axis).map(ValueMut::Number);
        }
        let axis = axis_of(rest.strip_prefix('r')?, "_rad")?;
        return Some(ValueMut::HomeRotation(&mut home.orientation_wxyz, axis));
    }
    if name == "laser.target_plane.offset_m" {
        let laser = robot.laser.as_mut()?;
        return Some(ValueMut::Number(&mut laser.target_plane.offset_m));
    }
    // A cable's name may contain dots, so the longest matching name is used.
    let fitting = robot.cables.iter_mut().filter(|cable| {
        let rest = name.strip_prefix(cable.name.as_str());
        rest.is_some_and(|rest| rest.starts_with('.'))
    });
    let cable = fitting.max_by_key(|cable| cable.name.len())?;
    let (part, number) = name.get(cable.name.len() + 1..)?.split_once('.')?;
    match (part, number) {
        ("pulley", "radius_m") => Some(ValueMut::NotNegative(&mut cable.pulley.radius_m)),
        ("winch", "drum_diameter_m") => Some(ValueMut::Positive(&mut cable.winch.drum_diameter_m)),
        ("entry_point", axis) => {
            let axis = axis_of(axis, "_m")?;
            let point = &mut cable.pulley.entry_point_m;
            point.get_mut(axis).map(ValueMut::Number)
        }
        ("platform_anchor", axis) => {
            let axis = axis_of(axis, "_m")?;
            let point = &mut cable.platform_anchor_m;
            point.get_mut(axis).map(ValueMut::Number)
        }
        _ => None,
    }
}

fn axis_of(name: &str, unit: &str) -> Option<usize> {
    let axis = name.strip_suffix(unit)?;
    AXES.iter().position(|known| *known == axis)
}

fn effect_place<'r>(robot: &'r mut Robot, rest: &str) -> Option<ValueMut<'r>> {
    let full = format!("effect.{rest}");
    let named = |(index, setting): (usize, &EffectSetting)| {
        let parameters = robot.effect(&setting.effect)?.parameters().iter();
        let mut names = parameters.map(|parameter| parameter.name);
        let name = names.find(|name| effect_name(setting, name) == full)?;
        Some((index, name))
    };
    let (index, name) = robot.effects.iter().enumerate().find_map(named)?;
    Some(ValueMut::Effect(&mut robot.effects[index], name.to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use tautline_core::robot::presets;

    fn robot() -> Robot {
        let mut robot = presets::find("mini").unwrap().robot;
        robot.effects = vec![EffectSetting {
            effect: "winch_scale".into(),
            targets: vec!["cable-3".into()],
            parameters: [("scale".to_owned(), 0.0)].into(),
        }];
        robot
    }

    #[test]
    fn every_parameter_that_is_listed_can_be_set() {
        let mut robot = robot();
        for parameter in parameters_of(&robot) {
            let value = parameter.value + 1e-3;
            set_parameter(&mut robot, &parameter.name, value).unwrap();
            let now = parameters_of(&robot);
            let now = now.iter().find(|p| p.name == parameter.name).unwrap();
            assert!((now.value - value).abs() < 1e-15, "{}", parameter.name);
        }
        let names: Vec<_> = parameters_of(&robot).into_iter().map(|p| p.name).collect();
        assert_eq!(names.len(), 8 * 8 + 6 + 1 + 1);
        assert!(names.contains(&"effect.winch_scale.cable-3.scale".to_owned()));
        assert_eq!(robot.effects[0].parameters["scale"], 1e-3);
    }

    #[test]
    fn names_of_effects_are_read_again() {
        for targets in [&[][..], &["left.upper"], &["cable-1", "cable-2"]] {
            let setting = EffectSetting {
                effect: "winch_scale".into(),
                targets: targets.iter().map(|&target| target.to_owned()).collect(),
                parameters: [].into(),
            };
            let name = effect_name(&setting, "scale");
            let expected = EffectName {
                effect: "winch_scale",
                targets: &targets.join("+"),
                parameter: "scale",
            };
            assert_eq!(EffectName::read(&name), Some(expected));
        }
        assert_eq!(EffectName::read("cable-1.pulley.radius_m"), None);
    }

    #[test]
    fn impossible_values_and_names_are_refused() {
        let mut robot = robot();
        let before = robot.clone();
        for (name, value) in [
            ("cable-1.winch.drum_diameter_m", 0.0),
            ("cable-1.pulley.radius_m", -0.1),
            ("home.x_m", f64::NAN),
        ] {
            let refused = set_parameter(&mut robot, name, value);
            assert!(matches!(refused, Err(LinkError::InvalidValue { .. })));
        }
        for name in [
            "cable-9.pulley.radius_m",
            "home.w_m",
            "effect.winch_scale.cable-4.scale",
        ] {
            let refused = set_parameter(&mut robot, name, 1.0);
            assert_eq!(refused, Err(LinkError::UnknownParameter(name.to_owned())));
        }
        assert_eq!(robot, before);
    }
    #[test]
    fn lengths_at_home_are_those_of_the_geometry() {
        let robot = robot();
        let lengths = home_lengths(&robot);
        assert_eq!(lengths.len(), 8);
        assert_eq!(lengths[2].name, "cable-3.home.length_m");
        // Without pulleys they are distances.
        let mut eyelets = robot.clone();
        for cable in &mut eyelets.cables {
            cable.pulley.radius_m = 0.0;
        }
        let home = eyelets.home.unwrap().pose();
        for (cable, length) in eyelets.cables.iter().zip(home_lengths(&eyelets)) {
            let anchor = home.transform(&cable.platform_anchor_m.into());
            let entry = Vector3::from(cable.pulley.entry_point_m);
            assert!((length.value - (entry - anchor).norm()).abs() < 1e-12);
        }
        eyelets.home = None;
        assert!(home_lengths(&eyelets).is_empty());
    }
}

//! Effects attached to the cables of a robot.

use std::collections::BTreeMap;

use super::{BoundEffect, Effect, EffectError, EffectParameter, EffectSetting, Scope};
use crate::robot::Robot;

/// A request to estimate an effect: `ID[:CABLE][:NAME=NUMBER,...]`, with two cables for a pair.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct EffectRequest {
    /// Identifier in the catalogue, or of a hypothesis of the robot.
    pub effect: String,
    /// Cables: one, or two of a pair; none for all cables that the scope of the effect admits.
    pub cables: Vec<String>,
    /// Values of the parameters that cannot be estimated, and start values of others.
    pub values: Vec<(String, f64)>,
}

impl EffectSetting {
    /// Parses `ID[:CABLE]..[:NAME=NUMBER,...]`; `:` may stand for `,` as well.
    ///
    /// # Errors
    /// If a parameter has no finite number.
    pub fn parse(text: &str) -> Result<Self, EffectError> {
        let mut parts = text.split(':').map(str::trim);
        let mut setting = Self {
            effect: parts.next().unwrap_or_default().to_owned(),
            targets: Vec::new(),
            parameters: BTreeMap::new(),
        };
        for part in parts {
            if !part.contains('=') {
                setting.targets.push(part.to_owned());
                continue;
            }
            for pair in part.split(',') {
                let value = pair
                    .split_once('=')
                    .and_then(|(name, value)| Some((name, value.trim().parse::<f64>().ok()?)));
                let Some((name, value)) = value.filter(|(_, value)| value.is_finite()) else {
                    return Err(EffectError::NoValue(pair.to_owned()));
                };
                let name = name.trim().to_owned();
                setting.parameters.insert(name, value);
            }
        }
        Ok(setting)
    }
}

impl From<EffectSetting> for EffectRequest {
    fn from(setting: EffectSetting) -> Self {
        Self {
            effect: setting.effect,
            cables: setting.targets,
            values: setting.parameters.into_iter().collect(),
        }
    }
}

impl EffectRequest {
    /// Parses the text of an [`EffectSetting`].
    ///
    /// # Errors
    /// If a parameter has no finite number.
    pub fn parse(text: &str) -> Result<Self, EffectError> {
        EffectSetting::parse(text).map(Self::from)
    }

    /// Attaches the effect to `robot` with the given values, else the start values, as parameters: one instance per
    /// cable if the effect has the scope of one cable and no cable is given.
    ///
    /// # Errors
    /// If effect, cable or parameter is unknown, the effect takes no cable or has nothing to estimate, or
    /// a parameter that cannot be estimated has no value.
    pub fn bind(&self, robot: &Robot) -> Result<Vec<BoundEffect>, EffectError> {
        let effect = (robot.effect(&self.effect))
            .ok_or_else(|| EffectError::UnknownEffect(self.effect.clone()))?;
        if !effect.is_estimable() {
            return Err(EffectError::NothingToEstimate(self.effect.clone()));
        }
        let targets: Vec<Vec<String>> = match &self.cables[..] {
            [] if effect.scope == Scope::Cable => {
                let cables = robot.cables.iter();
                cables.map(|cable| vec![cable.name.clone()]).collect()
            }
            [_, second, ..] if effect.scope != Scope::Pair => {
                return Err(EffectError::SecondCable {
                    effect: self.effect.clone(),
                    cable: second.clone(),
                });
            }
            cables => vec![cables.to_vec()],
        };
        let bound = |targets| {
            let setting = EffectSetting {
                effect: self.effect.clone(),
                targets,
                parameters: self.values.iter().cloned().collect(),
            };
            BoundEffect::to_estimate(&setting, robot)
        };
        targets.into_iter().map(bound).collect()
    }
}

/// Values of an effect's parameters: the given ones, else the defaults.
fn values_of<'n>(
    effect: &'static Effect,
    given: impl Iterator<Item = (&'n String, f64)>,
    default: impl Fn(&EffectParameter) -> f64,
) -> Result<Vec<f64>, EffectError> {
    let parameters = effect.parameters();
    let mut values: Vec<Option<f64>> = vec![None; parameters.len()];
    for (name, value) in given {
        let index = parameters.iter().position(|p| p.name == name);
        let index = index.ok_or_else(|| unknown_parameter(effect, name))?;
        if !value.is_finite() {
            return Err(EffectError::NotANumber {
                effect: effect.id().to_owned(),
                parameter: name.clone(),
            });
        }
        values[index] = Some(value);
    }
    let value = |(value, parameter): (Option<f64>, &EffectParameter)| match value {
        Some(value) => Ok(value),
        None if parameter.discrete && !parameter.optional => Err(EffectError::MissingParameter {
            effect: effect.id().to_owned(),
            parameter: parameter.name,
        }),
        None => Ok(default(parameter)),
    };
    values.into_iter().zip(parameters).map(value).collect()
}

fn unknown_parameter(effect: &Effect, name: &str) -> EffectError {
    let names: Vec<_> = effect.parameters().iter().map(|p| p.name).collect();
    EffectError::UnknownParameter {
        effect: effect.id().to_owned(),
        parameter: name.to_owned(),
        expected: if names.is_empty() {
            "none".to_owned()
        } else {
            names.join(", ")
        },
    }
}

/// Index of a cable given by its name or by its number, counted from 1.
fn cable_called(robot: &Robot, effect: &str, name: &str) -> Result<usize, EffectError> {
    let by_number = || {
        let number: usize = name.parse().ok()?;
        (1..=robot.cable_count())
            .contains(&number)
            .then(|| number - 1)
    };
    robot
        .cable_index(name)
        .or_else(by_number)
        .ok_or_else(|| EffectError::UnknownCable {
            effect: effect.to_owned(),
            cable: name.to_owned(),
        })
}

impl BoundEffect {
    /// Attaches an effect stated in a model file to the cables of `robot`; parameters not given are neutral.
    ///
    /// # Errors
    /// If effect, cable or parameter is unknown.
    pub fn from_setting(setting: &EffectSetting, robot: &Robot) -> Result<Self, EffectError> {
        Self::attach(setting, robot, |p| p.neutral)
    }

    /// Attaches an effect that is to be estimated; parameters not given take their start values.
    ///
    /// # Errors
    /// If effect, cable or parameter is unknown.
    pub fn to_estimate(setting: &EffectSetting, robot: &Robot) -> Result<Self, EffectError> {
        Self::attach(setting, robot, |p| p.start)
    }

    fn attach(
        setting: &EffectSetting,
        robot: &Robot,
        default: impl Fn(&EffectParameter) -> f64,
    ) -> Result<Self, EffectError> {
        let effect = (robot.effect(&setting.effect))
            .ok_or_else(|| EffectError::UnknownEffect(setting.effect.clone()))?;
        if effect.scope() == Scope::Robot && !setting.targets.is_empty() {
            return Err(EffectError::NoTarget(setting.effect.clone()));
        }
        let named = effect
            .text_physics
            .map_or(0, |physics| physics.highest_cable());
        if named > robot.cable_count() {
            return Err(EffectError::UnknownCable {
                effect: setting.effect.clone(),
                cable: named.to_string(),
            });
        }
        let given = setting
            .parameters
            .iter()
            .map(|(name, value)| (name, *value));
        let values = values_of(effect, given, default)?;
        let named: Result<Vec<usize>, _> = setting
            .targets
            .iter()
            .map(|name| cable_called(robot, &setting.effect, name))
            .collect();
        let named = named?;
        let is_pair = matches!(*named, [one, other] if one != other);
        if effect.scope() == Scope::Pair && !is_pair {
            return Err(EffectError::NeedsPair(setting.effect.clone()));
        }
        let targeted = !setting.targets.is_empty();
        let cables = if targeted {
            named
        } else {
            (0..robot.cable_count()).collect()
        };
        Ok(Self {
            effect,
            cables,
            targeted,
            values,
        })
    }
}

//! Effects attached to the cables of a robot.

use super::{Effect, EffectSetting, Scope, find};
use crate::robot::Robot;

/// Why an effect cannot be attached.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum EffectError {
    /// The identifier is not in the catalogue.
    #[error("unknown effect \"{0}\"")]
    UnknownEffect(String),
    /// The robot has no cable of this name.
    #[error("effect \"{effect}\": the robot has no cable \"{cable}\"")]
    UnknownCable {
        /// Effect concerned.
        effect: String,
        /// Name that was looked for.
        cable: String,
    },
    /// The effect has no parameter of this name.
    #[error("effect \"{effect}\" has no parameter \"{parameter}\"; it has {expected}")]
    UnknownParameter {
        /// Effect concerned.
        effect: String,
        /// Name that was looked for.
        parameter: String,
        /// The names it has.
        expected: String,
    },
    /// The effect concerns the whole robot.
    #[error("effect \"{0}\" concerns the whole robot and takes no cable")]
    NoTarget(String),
}

/// An effect that is to be estimated: `ID` or `ID:CABLE`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct EffectRequest {
    /// Identifier in the catalogue.
    pub effect: String,
    /// Cable, or all that the effect's scope says.
    pub cable: Option<String>,
}

impl EffectRequest {
    /// Reads `ID` or `ID:CABLE`.
    #[must_use]
    pub fn parse(text: &str) -> Self {
        match text.split_once(':') {
            Some((effect, cable)) => Self {
                effect: effect.to_owned(),
                cable: Some(cable.to_owned()),
            },
            None => Self {
                effect: text.to_owned(),
                cable: None,
            },
        }
    }

    /// Attaches the effect to `robot`, its parameters at no effect: one instance per cable where the
    /// effect is per cable and no cable is given.
    ///
    /// # Errors
    /// If effect or cable are unknown, or the effect takes no cable.
    pub fn bind(&self, robot: &Robot) -> Result<Vec<BoundEffect>, EffectError> {
        let effect =
            find(&self.effect).ok_or_else(|| EffectError::UnknownEffect(self.effect.clone()))?;
        let all: Vec<usize> = (0..robot.cable_count()).collect();
        let neutral = |cables: Vec<usize>, targeted: bool| BoundEffect {
            effect,
            cables,
            targeted,
            values: vec![0.0; effect.parameters().len()],
        };
        match (&self.cable, effect.scope()) {
            (Some(_), Scope::Robot) => Err(EffectError::NoTarget(self.effect.clone())),
            (Some(name), _) => {
                let cable = cable_called(robot, &self.effect, name)?;
                Ok(vec![neutral(vec![cable], true)])
            }
            (None, Scope::Cable) => Ok(all.iter().map(|i| neutral(vec![*i], true)).collect()),
            (None, _) => Ok(vec![neutral(all, false)]),
        }
    }
}

/// A cable by its name, or by its number from 1.
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

/// An effect attached to cables, with parameter values.
#[derive(Clone)]
pub struct BoundEffect {
    /// The effect.
    pub effect: &'static dyn Effect,
    /// Cables that share these parameters.
    pub cables: Vec<usize>,
    /// Whether it is attached to particular cables rather than to the whole robot.
    pub targeted: bool,
    /// Value of each parameter.
    pub values: Vec<f64>,
}

impl BoundEffect {
    /// Attaches the effect of a model file to the cables of `robot`.
    ///
    /// # Errors
    /// If effect, cable or parameter are unknown.
    pub fn from_setting(setting: &EffectSetting, robot: &Robot) -> Result<Self, EffectError> {
        let effect = find(&setting.effect)
            .ok_or_else(|| EffectError::UnknownEffect(setting.effect.clone()))?;
        if effect.scope() == Scope::Robot && !setting.targets.is_empty() {
            return Err(EffectError::NoTarget(setting.effect.clone()));
        }
        let mut values = vec![0.0; effect.parameters().len()];
        for (name, value) in &setting.parameters {
            let index = effect.parameters().iter().position(|p| p.name == name);
            let index = index.ok_or_else(|| EffectError::UnknownParameter {
                effect: setting.effect.clone(),
                parameter: name.clone(),
                expected: effect
                    .parameters()
                    .iter()
                    .map(|p| p.name)
                    .collect::<Vec<_>>()
                    .join(", "),
            })?;
            values[index] = *value;
        }
        let named: Result<Vec<usize>, _> = setting
            .targets
            .iter()
            .map(|name| cable_called(robot, &setting.effect, name))
            .collect();
        let targeted = !setting.targets.is_empty();
        let cables = if targeted {
            named?
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

    /// The form in which model files carry it.
    #[must_use]
    pub fn setting(&self, robot: &Robot) -> EffectSetting {
        let targets = if self.targeted {
            self.cables
                .iter()
                .map(|i| robot.cables[*i].name.clone())
                .collect()
        } else {
            Vec::new()
        };
        let names = self.effect.parameters().iter().map(|p| p.name.to_owned());
        EffectSetting {
            effect: self.effect.id().to_owned(),
            targets,
            parameters: names.zip(self.values.iter().copied()).collect(),
        }
    }
}

impl std::fmt::Debug for BoundEffect {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "{} on {:?} = {:?}",
            self.effect.id(),
            self.cables,
            self.values
        )
    }
}

//! Effects attached to the cables of a robot.

use super::{Effect, EffectParameter, EffectSetting, Scope, find};
use crate::measurement::Measurements;
use crate::robot::Robot;

/// Errors of attaching an effect to a robot.
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
        /// Name that was given.
        cable: String,
    },
    /// The effect has no parameter of this name.
    #[error("effect \"{effect}\" has no parameter \"{parameter}\"; it has {expected}")]
    UnknownParameter {
        /// Effect concerned.
        effect: String,
        /// Name that was given.
        parameter: String,
        /// The parameters of the effect.
        expected: String,
    },
    /// The effect concerns the whole robot.
    #[error("effect \"{0}\" concerns the whole robot and takes no cable")]
    NoTarget(String),
    /// The effect concerns two cables.
    #[error("effect \"{0}\" concerns two different cables: name both")]
    NeedsPair(String),
    /// No value is given for a parameter that cannot be estimated.
    #[error(
        "effect \"{effect}\" needs a number for \"{parameter}\", which cannot be estimated: give {parameter}=NUMBER"
    )]
    MissingParameter {
        /// Effect concerned.
        effect: String,
        /// The parameter.
        parameter: &'static str,
    },
    /// A parameter has no finite value.
    #[error("effect \"{effect}\": expected a number for \"{parameter}\"")]
    NotANumber {
        /// Effect concerned.
        effect: String,
        /// The parameter.
        parameter: String,
    },
    /// The effect has no parameter that readings can determine.
    #[error(
        "effect \"{0}\" has no parameter that can be estimated: it can only be simulated or stated in a model file"
    )]
    NothingToEstimate(String),
    /// There is no such pose.
    #[error("effect \"{effect}\": there is no pose labelled {pose}")]
    NoSuchPose {
        /// Effect concerned.
        effect: String,
        /// Label that was given.
        pose: String,
    },
}

/// A request to estimate an effect: `ID[:CABLE][:NAME=NUMBER,...]`.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct EffectRequest {
    /// Identifier in the catalogue.
    pub effect: String,
    /// Cable; `None` for all cables that the scope of the effect admits.
    pub cable: Option<String>,
    /// Values of the parameters that cannot be estimated, and start values of others; NaN where the text is not
    /// a number.
    pub values: Vec<(String, f64)>,
}

impl EffectRequest {
    /// Parses `ID[:CABLE][:NAME=NUMBER,...]`; `:` may stand for `,` as well.
    #[must_use]
    pub fn parse(text: &str) -> Self {
        let mut parts = text.split(':');
        let mut request = Self {
            effect: parts.next().unwrap_or_default().to_owned(),
            ..Self::default()
        };
        for part in parts {
            if !part.contains('=') {
                request.cable = Some(part.to_owned());
                continue;
            }
            for pair in part.split(',') {
                let (name, value) = pair.split_once('=').unwrap_or((pair, ""));
                let value = value.trim().parse().unwrap_or(f64::NAN);
                request.values.push((name.trim().to_owned(), value));
            }
        }
        request
    }

    /// Attaches the effect to `robot` with the given values, else the start values, as parameters: one instance per
    /// cable if the effect has the scope of one cable and no cable is given.
    ///
    /// # Errors
    /// If effect, cable or parameter is unknown, the effect takes no cable or has nothing to estimate, or
    /// a parameter that cannot be estimated has no value.
    pub fn bind(&self, robot: &Robot) -> Result<Vec<BoundEffect>, EffectError> {
        let effect =
            find(&self.effect).ok_or_else(|| EffectError::UnknownEffect(self.effect.clone()))?;
        if !effect.is_estimable() {
            return Err(EffectError::NothingToEstimate(self.effect.clone()));
        }
        let targets: Vec<Vec<String>> = match &self.cable {
            Some(name) => vec![vec![name.clone()]],
            None if effect.scope == Scope::Cable => {
                let cables = robot.cables.iter();
                cables.map(|cable| vec![cable.name.clone()]).collect()
            }
            None => vec![Vec::new()],
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

/// An effect attached to cables, with parameter values.
#[derive(Clone)]
pub struct BoundEffect {
    /// The effect.
    pub effect: &'static Effect,
    /// Cables that share these parameters.
    pub cables: Vec<usize>,
    /// Whether it is attached to individual cables rather than to the whole robot.
    pub targeted: bool,
    /// Value of each parameter.
    pub values: Vec<f64>,
}

impl BoundEffect {
    /// Whether it acts on the platform, the frame or an instrument.
    pub(crate) fn acts_on_platform(&self) -> bool {
        self.effect.scope() == Scope::Robot
    }

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
        let effect = find(&setting.effect)
            .ok_or_else(|| EffectError::UnknownEffect(setting.effect.clone()))?;
        if effect.scope() == Scope::Robot && !setting.targets.is_empty() {
            return Err(EffectError::NoTarget(setting.effect.clone()));
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

    /// Checks that every pose the effect refers to is in `data`.
    ///
    /// # Errors
    /// If it refers to a pose that is not there.
    pub fn check_poses(&self, data: &Measurements) -> Result<(), EffectError> {
        let Some(index) = self.effect.pose_parameter() else {
            return Ok(());
        };
        let pose = self.values[index];
        if data.labels.iter().any(|label| *label as f64 == pose) {
            return Ok(());
        }
        Err(EffectError::NoSuchPose {
            effect: self.effect.id().to_owned(),
            pose: pose.to_string(),
        })
    }

    /// Swaps the channels that the effect states as exchanged; applying it twice changes nothing.
    pub fn exchange_channels(&self, data: &mut Measurements) {
        (self.effect.exchange_channels)(&self.cables, &self.values, data);
    }

    /// The effect in the form of model files.
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

//! An effect on some cables with values of its parameters.

use super::{
    CablePorts, Dual, Effect, EffectSetting, PlatformPorts, PoseContexts, RowContexts, Scope,
    Search,
};
use crate::measurement::Measurements;
use crate::robot::{Cable, Robot};

/// Errors of attaching an effect to a robot.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum EffectError {
    /// The identifier is neither in the catalogue nor that of a hypothesis of the robot.
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
    /// The effect is estimated on one cable, or on each by itself.
    #[error("effect \"{effect}\": found a second cable \"{cable}\", expected one cable")]
    SecondCable {
        /// Effect concerned.
        effect: String,
        /// The second cable.
        cable: String,
    },
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
    /// A parameter is not followed by its number.
    #[error("found \"{0}\", expected NAME=NUMBER")]
    NoValue(String),
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
    /// There is no distance between poses in this row.
    #[error("effect \"{effect}\": there is no distance in row {row} of the distances")]
    NoSuchDistance {
        /// Effect concerned.
        effect: String,
        /// Row that was given.
        row: String,
    },
}

/// An effect attached to cables, with parameter values.
#[derive(Clone)]
pub struct BoundEffect {
    /// The effect.
    pub effect: &'static Effect,
    /// Cables that share these parameters.
    pub cables: Vec<usize>,
    /// Whether the effect is attached to individual cables rather than to the robot or to all cables in common.
    pub targeted: bool,
    /// Value of each parameter.
    pub values: Vec<f64>,
}

impl BoundEffect {
    /// Whether the effect acts on the platform, the frame or an instrument.
    pub(crate) fn acts_on_platform(&self) -> bool {
        self.effect.scope() == Scope::Robot
    }

    /// Changes the ports of the cable with an index, one of those it is attached to.
    pub(crate) fn change_cable(
        &self,
        values: &[Dual],
        row: RowContexts<'_>,
        cable: usize,
        ports: &mut CablePorts,
    ) {
        match self.effect.text_physics {
            Some(physics) => physics.change_cable(values, row, (cable, &self.cables), ports),
            None => (self.effect.change_cable)(values, &row.cables[cable], ports),
        }
    }

    /// Changes the ports of the platform.
    pub(crate) fn change_platform(
        &self,
        values: &[Dual],
        row: RowContexts<'_>,
        ports: &mut PlatformPorts,
    ) {
        match self.effect.text_physics {
            Some(physics) => physics.change_platform(values, row, ports),
            None => (self.effect.change_platform)(values, row.platform, ports),
        }
    }

    /// Whether `other` is the same effect on the same target, whatever its values.
    #[must_use]
    pub fn has_target_of(&self, other: &Self) -> bool {
        std::ptr::eq(self.effect, other.effect)
            && self.cables == other.cables
            && self.targeted == other.targeted
    }

    /// Checks that the pose or the distance that the effect refers to is in `data`.
    ///
    /// # Errors
    /// If it is not there.
    pub fn check_poses(&self, data: &Measurements) -> Result<(), EffectError> {
        if let Search::AtDistance(index) = self.effect.search() {
            let row = self.values[index];
            let is_there = data.distances.iter().any(|one| one.number as f64 == row);
            return match is_there {
                true => Ok(()),
                false => Err(EffectError::NoSuchDistance {
                    effect: self.effect.id().to_owned(),
                    row: row.to_string(),
                }),
            };
        }
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

impl PoseContexts {
    /// The nominal ports of all cables at a row under given tensions (N), with the effects applied and no cable paid out.
    pub fn cable_ports(
        &self,
        row: usize,
        robot: &Robot,
        effects: &[BoundEffect],
        tensions_n: &[f64],
    ) -> Vec<CablePorts> {
        let mut cables = self.at_row(row).cables.to_vec();
        for (at, tension_n) in cables.iter_mut().zip(tensions_n) {
            at.tension_n = *tension_n;
        }
        let contexts = RowContexts {
            cables: &cables,
            platform: self.platform(row),
        };
        let changed = |(index, cable): (usize, &Cable)| {
            let mut ports = CablePorts::nominal(cable, 0.0, tensions_n[index]);
            for bound in effects.iter().filter(|b| b.cables.contains(&index)) {
                let values = bound.values.iter().map(|value| Dual::constant(*value));
                let values: Vec<Dual> = values.collect();
                bound.change_cable(&values, contexts, index, &mut ports);
            }
            ports
        };
        robot.cables.iter().enumerate().map(changed).collect()
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

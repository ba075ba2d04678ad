//! Deviations of parts within their tolerances: small effects that every real machine has.

use std::f64::consts::FRAC_PI_2;

use super::{BoundEffect, Effect, MachineClass, Scope, Search, every_effect};
use crate::robot::{PartTolerances, Robot, StatedTolerances};

/// The deviation of one part from its description, with its prior standard deviation.
///
/// A wave has no phase of its own at amplitude zero, so it is two deviations: the amplitudes of a wave of phase 0 and of
/// one of phase 90 degrees.
#[derive(Debug, Clone)]
pub struct PartDeviation {
    /// The effect on the part, with neutral values.
    pub bound: BoundEffect,
    /// Prior standard deviation of each parameter; 0 for one that is held.
    pub prior_sd: Vec<f64>,
}

impl PartDeviation {
    /// Whether an effect describes the whole deviation of this part, as a cause outside its tolerance does.
    #[must_use]
    pub fn is_covered_by(&self, effect: &BoundEffect) -> bool {
        self.bound.has_target_of(effect)
    }

    /// Whether an effect is an estimate of this deviation: on the same part, with the same held values, such as the phase.
    #[must_use]
    pub fn is_estimated_by(&self, found: &BoundEffect) -> bool {
        let values = found.values.iter().zip(&self.bound.values);
        let mut values = values.zip(&self.prior_sd);
        self.is_covered_by(found) && values.all(|((a, b), sd)| *sd > 0.0 || a == b)
    }

    /// The same with the standard deviations multiplied by a factor.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        Self {
            bound: self.bound.clone(),
            prior_sd: self.prior_sd.iter().map(|sd| factor * sd).collect(),
        }
    }
}

/// The deviations of all parts of a robot for which there are tolerances, each cable by itself.
#[must_use]
pub fn part_deviations(robot: &Robot, tolerances: &PartTolerances) -> Vec<PartDeviation> {
    let mut deviations = Vec::new();
    for effect in every_effect().filter(|effect| effect.has_tolerance()) {
        let targets: Vec<Vec<usize>> = match effect.scope() {
            Scope::Cable | Scope::CableOrAll => (0..robot.cable_count()).map(|c| vec![c]).collect(),
            Scope::Robot => vec![Vec::new()],
            Scope::Pair => Vec::new(),
        };
        for cables in targets {
            let sd = match tolerances {
                PartTolerances::Typical(_) => typical_sd(effect, MachineClass::of(robot)),
                PartTolerances::Stated(stated) => stated_sd(stated, effect, robot, &cables),
            };
            if sd.iter().any(|sd| *sd > 0.0) {
                push(&mut deviations, robot, effect, &cables, &sd);
            }
        }
    }
    deviations
}

/// Typical standard deviation of each parameter.
fn typical_sd(effect: &Effect, class: MachineClass) -> Vec<f64> {
    let of = |p: &super::EffectParameter| p.tolerance.map_or(0.0, |typical| typical.sd(class));
    effect.parameters().iter().map(of).collect()
}

/// Stated standard deviation of each parameter that measures the size of an effect.
fn stated_sd(
    stated: &StatedTolerances,
    effect: &Effect,
    robot: &Robot,
    cables: &[usize],
) -> Vec<f64> {
    let cable = cables
        .first()
        .map(|cable| robot.cables[*cable].name.as_str());
    let sd = stated.factor * stated.sd_of(effect.id(), cable);
    let all = 0..effect.parameters().len();
    all.map(|k| if effect.is_size(k) { sd } else { 0.0 })
        .collect()
}

fn push(
    deviations: &mut Vec<PartDeviation>,
    robot: &Robot,
    effect: &'static Effect,
    cables: &[usize],
    sd: &[f64],
) {
    let targeted = !cables.is_empty();
    let all = || (0..robot.cable_count()).collect();
    let at = |values| PartDeviation {
        bound: BoundEffect {
            effect,
            cables: if targeted { cables.to_vec() } else { all() },
            targeted,
            values,
        },
        prior_sd: sd.to_vec(),
    };
    let neutral = effect.neutral_values();
    if let Search::Wave { phase, .. } = effect.search() {
        for angle in [0.0, FRAC_PI_2] {
            let mut values = neutral.clone();
            values[phase] = angle;
            deviations.push(at(values));
        }
    } else {
        deviations.push(at(neutral));
    }
}

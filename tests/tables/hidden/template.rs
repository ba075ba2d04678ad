//! Draws everything about an effect except its size.

use std::collections::BTreeMap;

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use tautline_core::effect::{Effect, EffectParameter, EffectSetting, Scope, Search};
use tautline_core::robot::Robot;

use super::TestRobot;

/// Effects whose parameter is positive by nature: backlash, friction, compliance, expansion of steel, creep under
/// tension, and weight.
const POSITIVE: [&str; 6] = [
    "winch_backlash",
    "pulley_friction",
    "frame_compliance",
    "frame_thermal",
    "cable_creep",
    "cable_sag",
];

/// Probability that an effect of one cable or all cables is put on one cable.
const ONE_CABLE: f64 = 0.7;

/// Minimum number of poses before and after an event.
const BESIDE_EVENT: i64 = 3;

/// An effect with targets, directions and all other parameters except its size.
#[derive(Clone)]
pub struct Template {
    /// Kind of effect.
    pub effect: &'static Effect,
    /// Names of the target cables.
    pub targets: Vec<String>,
    /// Smallest and largest typical size; `None` if the effect has no size.
    pub typical: Option<[f64; 2]>,
    /// How each parameter depends on the size.
    values: Vec<Value>,
}

#[derive(Clone, Copy)]
enum Value {
    /// Proportional to the size.
    PerSize(f64),
    /// Independent of the size.
    Fixed(f64),
}

impl Template {
    /// Draws targets, signs, directions, phases and poses.
    pub fn draw(effect: &'static Effect, of: &TestRobot, rng: &mut ChaCha8Rng) -> Self {
        let robot = &of.preset.robot;
        let parameters = effect.parameters();
        let mut values: Vec<Value> = (0..parameters.len())
            .map(|k| fixed(effect, k, of.poses, rng).map_or(Value::PerSize(0.0), Value::Fixed))
            .collect();
        let sized: Vec<usize> = (0..values.len())
            .filter(|k| matches!(values[*k], Value::PerSize(_)))
            .collect();
        let direction = direction(effect.id(), sized.len(), rng);
        let turns = build_up_turns(effect.id(), robot);
        for (k, component) in sized.iter().zip(direction) {
            values[*k] = Value::PerSize(component);
        }
        Self {
            effect,
            targets: targets(effect.scope(), robot, rng),
            typical: (sized.first()).map(|k| typical(&parameters[*k]).map(|size| size / turns)),
            values,
        }
    }

    /// The effect with a given size.
    #[must_use]
    pub fn setting(&self, size: f64) -> EffectSetting {
        let value = |value: &Value| match value {
            Value::PerSize(v) => v * size,
            Value::Fixed(v) => *v,
        };
        let names = self.effect.parameters().iter().map(|p| p.name.to_owned());
        let parameters: BTreeMap<_, _> = names.zip(self.values.iter().map(value)).collect();
        EffectSetting {
            effect: self.effect.id().to_owned(),
            targets: self.targets.clone(),
            parameters,
        }
    }
}

/// Typical range of sizes. Ranges of either sign become positive.
fn typical(parameter: &EffectParameter) -> [f64; 2] {
    let [a, b] = parameter.typical.map(f64::abs);
    [a.min(b), a.max(b)]
}

/// Layers build up per turn of the drum, while the parameter counts turns of the motor.
fn build_up_turns(id: &str, robot: &Robot) -> f64 {
    if id == "drum_growth" {
        robot.cables[0].winch.gear_ratio
    } else {
        1.0
    }
}

/// Value of a parameter that does not depend on the size; `None` for other parameters.
fn fixed(effect: &Effect, k: usize, poses: usize, rng: &mut ChaCha8Rng) -> Option<f64> {
    let parameter = &effect.parameters()[k];
    let last = poses as i64;
    match effect.search() {
        Search::Wave { phase, .. } if phase == k => {
            Some(std::f64::consts::PI * rng.random_range(-1.0..1.0))
        }
        Search::Wave { period, .. } if period == Some(k) => {
            Some(log_uniform(parameter.typical, rng))
        }
        Search::FromPose(pose) if pose == k => {
            Some(rng.random_range(1 + BESIDE_EVENT..=last - BESIDE_EVENT) as f64)
        }
        Search::Exchange => Some(parameter.neutral),
        Search::AtPose(pose) if pose == k => Some(rng.random_range(1..=last) as f64),
        _ => None,
    }
}

/// Draws a number log-uniformly from a range.
pub(crate) fn log_uniform([low, high]: [f64; 2], rng: &mut ChaCha8Rng) -> f64 {
    low * (high / low).powf(rng.random_range(0.0..=1.0))
}

/// Draws a unit vector of any direction, or of the physically possible sign.
fn direction(id: &str, count: usize, rng: &mut ChaCha8Rng) -> Vec<f64> {
    if POSITIVE.contains(&id) {
        return vec![1.0; count];
    }
    loop {
        let v: Vec<f64> = (0..count).map(|_| rng.random_range(-1.0..=1.0)).collect();
        let norm = v.iter().map(|x| x * x).sum::<f64>().sqrt();
        if count == 0 || (norm > 0.1 && norm <= 1.0) {
            return v.iter().map(|x| x / norm).collect();
        }
    }
}

fn targets(scope: Scope, robot: &Robot, rng: &mut ChaCha8Rng) -> Vec<String> {
    let count = robot.cable_count();
    let first = rng.random_range(0..count);
    let other = (first + rng.random_range(1..count)) % count;
    let all = rng.random_range(0.0..1.0) > ONE_CABLE;
    let chosen = match scope {
        Scope::Robot => vec![],
        Scope::CableOrAll if all => vec![],
        Scope::Pair => vec![first, other],
        Scope::Cable | Scope::CableOrAll => vec![first],
    };
    chosen
        .iter()
        .map(|k| robot.cables[*k].name.clone())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tables::hidden::robots::robots;
    use rand::SeedableRng;
    use tautline_core::effect::{BoundEffect, CATALOGUE};

    #[test]
    fn templates_can_be_bound_and_have_the_given_size() {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        for robot in robots() {
            for effect in CATALOGUE {
                let template = Template::draw(effect, &robot, &mut rng);
                let Some([low, high]) = template.typical else {
                    assert_eq!(effect.id(), "cable_swap");
                    continue;
                };
                assert!(0.0 < low && low < high, "{}", effect.id());
                let setting = template.setting(high);
                let bound = BoundEffect::from_setting(&setting, &robot.preset.robot).unwrap();
                let twice = template.setting(2.0 * high);
                let difference = setting.parameters.iter().zip(&twice.parameters);
                let size: f64 = difference.map(|((_, a), (_, b))| (b - a).powi(2)).sum();
                assert!((size.sqrt() / high - 1.0).abs() < 1e-9, "{bound:?}");
            }
        }
    }
}

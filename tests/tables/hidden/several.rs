//! Draws several effects at once, and families of effects.

use anyhow::{Result, bail};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use tautline_core::effect::{CATALOGUE, Effect, EffectSetting};

use super::draw::NEGLIGIBLE;
use super::setup::Setup;
use super::template::{Template, log_uniform};
use super::visibility::{VISIBLE, chi2_of_nearest_other, noncentrality};
use crate::tables::simulated::{random_sign, setting};

/// Maximum number of failed draws before a plan is given up.
const MAX_DRAWS: usize = 600;
/// Smallest noncentrality that any other single effect must leave unexplained for an effect to count as separated. The
/// exact log Bayes factor is then 16 on average and exceeds 3 (odds of 20 to 1) in 98.9 % of datasets.
const SEPARATED: f64 = 32.0;
/// Mean number of causes.
const CAUSES: f64 = 0.8;
/// Probability that a size exceeds the typical ones, and largest factor by which it does.
const ATYPICAL_SHARE: f64 = 0.04;
const ATYPICAL_FACTOR: f64 = 4.0;
/// Range of the common offset of all cables (m).
const COMMON_OFFSET_M: [f64; 2] = [0.05, 0.2];
/// Range of the winch scales of a family.
const WINCH_SCALE: [f64; 2] = [0.01, 0.03];

/// Effects, and the noncentrality of each with the others estimated.
pub type DrawnEffects = (Vec<EffectSetting>, Vec<f64>);

/// Draws an estimable effect, because noncentralities are computed with the other effects estimated.
fn any_effect(rng: &mut ChaCha8Rng) -> &'static Effect {
    loop {
        let effect = CATALOGUE[rng.random_range(0..CATALOGUE.len())];
        if effect.is_estimable() {
            return effect;
        }
    }
}

/// Draws an effect whose size is log-uniform in the typical range.
fn typical(setup: &Setup, rng: &mut ChaCha8Rng) -> EffectSetting {
    let template = Template::draw(any_effect(rng), &setup.robot, rng);
    let range = template.typical.unwrap_or([1.0, 1.0]);
    template.setting(log_uniform(range, rng))
}

/// Noncentrality of each effect with the others estimated; 0 where the effects break the robot.
fn each_noncentrality(setup: &Setup, effects: &[EffectSetting]) -> Vec<f64> {
    let beside = |n: usize| {
        let others = [&effects[..n], &effects[n + 1..]].concat();
        noncentrality(setup, &effects[n], &others).unwrap_or(0.0)
    };
    (0..effects.len()).map(beside).collect()
}

/// Draws three to five effects of typical size, each visible while the others are estimated.
///
/// # Errors
/// If none are found.
pub fn several(setup: &Setup, rng: &mut ChaCha8Rng) -> Result<DrawnEffects> {
    let count = rng.random_range(3..=5);
    let mut effects: Vec<EffectSetting> = Vec::new();
    for _ in 0..MAX_DRAWS {
        effects.push(typical(setup, rng));
        let last = effects.len() - 1;
        let others = &effects[..last];
        if noncentrality(setup, &effects[last], others).is_ok_and(|seen| seen >= VISIBLE) {
            let seen = each_noncentrality(setup, &effects);
            if seen.iter().all(|value| *value >= VISIBLE) {
                if effects.len() == count {
                    return Ok((effects, seen));
                }
                continue;
            }
        }
        effects.pop();
    }
    bail!("no {count} effects found for {}", setup.robot.name)
}

/// Draws one visible effect of typical size; if `separated`, one that no other effect can be mistaken for.
///
/// # Errors
/// If none is found.
pub fn one(setup: &Setup, separated: bool, rng: &mut ChaCha8Rng) -> Result<DrawnEffects> {
    for _ in 0..MAX_DRAWS {
        let effect = typical(setup, rng);
        let Ok(seen) = noncentrality(setup, &effect, &[]) else {
            continue;
        };
        if seen >= VISIBLE
            && (!separated || chi2_of_nearest_other(setup, &effect, SEPARATED)? >= SEPARATED)
        {
            return Ok((vec![effect], vec![seen]));
        }
    }
    bail!("no effect found for {}", setup.robot.name)
}

/// Draws effects from the prior of the diagnosis: a random number of them, of typical sizes and rarely beyond.
///
/// # Errors
/// If every draw breaks the robot.
pub fn by_chance(setup: &Setup, rng: &mut ChaCha8Rng) -> Result<DrawnEffects> {
    for _ in 0..MAX_DRAWS {
        let mut effects = Vec::new();
        // A Poisson number, by adding exponential waiting times until they exceed 1.
        let mut waited = 0.0;
        loop {
            waited -= rng.random_range(f64::MIN_POSITIVE..1.0).ln() / CAUSES;
            if waited > 1.0 {
                break;
            }
            let template = Template::draw(any_effect(rng), &setup.robot, rng);
            let [smallest, largest] = template.typical.unwrap_or([1.0, 1.0]);
            let range = match rng.random_bool(ATYPICAL_SHARE) {
                true => [largest, ATYPICAL_FACTOR * largest],
                false => [smallest, largest],
            };
            let effect = template.setting(log_uniform(range, rng));
            // An effect without a reading that depends on it cannot be estimated.
            if noncentrality(setup, &effect, &[]).is_ok_and(|seen| seen >= NEGLIGIBLE) {
                effects.push(effect);
            }
        }
        if setup.exact(&effects).is_ok() {
            let seen = each_noncentrality(setup, &effects);
            return Ok((effects, seen));
        }
    }
    bail!("nothing drawn leaves {} whole", setup.robot.name)
}

fn signed(range: [f64; 2], rng: &mut ChaCha8Rng) -> f64 {
    random_sign(rng) * rng.random_range(range[0]..=range[1])
}

/// Draws one offset common to all cables.
///
/// # Errors
/// If the robot cannot be simulated.
pub fn common_offset(setup: &Setup, rng: &mut ChaCha8Rng) -> Result<DrawnEffects> {
    let effect = setting("winch_offset", &[], "offset", signed(COMMON_OFFSET_M, rng));
    let seen = noncentrality(setup, &effect, &[])?;
    Ok((vec![effect], vec![seen]))
}

/// Draws a different scale for every winch, and a different gain and bias for every force sensor, of typical sizes.
#[must_use]
pub fn families(setup: &Setup, rng: &mut ChaCha8Rng) -> DrawnEffects {
    let cables = &setup.robot.preset.robot.cables;
    let typical = |id: &str| {
        let effect = tautline_core::effect::find(id);
        effect.map_or([0.0; 2], |effect| effect.parameters()[0].typical)
    };
    let members = [
        ("winch_scale", "scale", WINCH_SCALE),
        ("force_gain", "change", typical("force_gain")),
        ("force_bias", "bias", typical("force_bias")),
    ];
    let mut effects = Vec::new();
    for (id, parameter, range) in members {
        for cable in cables {
            effects.push(setting(id, &[&cable.name], parameter, signed(range, rng)));
        }
    }
    let seen = each_noncentrality(setup, &effects);
    (effects, seen)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tables::hidden::robots::robot;
    use crate::tables::hidden::{Circumstances, Conditions};
    use rand::SeedableRng;

    fn setup(name: &str, circumstances: Circumstances) -> (Setup, ChaCha8Rng) {
        let mut rng = ChaCha8Rng::seed_from_u64(7);
        let setup = Setup {
            robot: robot(name).unwrap(),
            seed: 7,
            conditions: Conditions::draw(circumstances, &mut rng),
        };
        (setup, rng)
    }

    #[test]
    fn several_effects_are_each_visible_beside_the_others() {
        let (setup, mut rng) = setup("planar", Circumstances::OtherNoise);
        let (effects, seen) = several(&setup, &mut rng).unwrap();
        assert!((3..=5).contains(&effects.len()));
        assert!(seen.len() == effects.len() && seen.iter().all(|v| *v >= VISIBLE));
    }

    #[test]
    fn a_common_offset_is_visible_without_known_anchors() {
        let (setup, mut rng) = setup("planar-unmeasured", Circumstances::ModelError);
        let (_, seen) = common_offset(&setup, &mut rng).unwrap();
        assert!(seen[0] > 10.0 * VISIBLE, "{seen:?}");
    }

    #[test]
    fn families_have_twelve_members_on_four_cables_that_are_visible() {
        let (setup, mut rng) = setup("hanging", Circumstances::AsStated);
        let (effects, seen) = families(&setup, &mut rng);
        assert_eq!(effects.len(), 12);
        assert!(
            seen.iter().filter(|v| **v >= VISIBLE).count() >= 8,
            "{seen:?}"
        );
    }
}

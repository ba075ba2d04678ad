//! Visibility of effects, determined by fits and independently of the diagnosis.

use anyhow::{Result, ensure};
use tautline_core::effect::{
    BoundEffect, CATALOGUE, Effect, EffectRequest, EffectSetting, Scope, Search,
};
use tautline_core::estimation::{Geometry, Problem};
use tautline_core::measurement::Dataset;
use tautline_core::robot::Robot;

use super::Setup;
use crate::tables::simulated::solved;

/// Noncentrality from which an effect counts as visible. A test corrected for some hundred hypotheses detects it with a
/// probability of about 0.99.
pub const VISIBLE: f64 = 40.0;
/// Range of noncentralities of effects that are just visible.
pub const JUST_VISIBLE: [f64; 2] = [25.0, 60.0];

/// Noncentrality of an effect with others estimated: the chi-square of a model without it for noise-free data.
///
/// # Errors
/// If the effects break the robot, or the true model does not explain the data.
pub fn noncentrality(
    setup: &Setup,
    effect: &EffectSetting,
    others: &[EffectSetting],
) -> Result<f64> {
    let all: Vec<EffectSetting> = [effect].into_iter().chain(others).cloned().collect();
    let exact = setup.exact(&all)?;
    let without = setup.visibility_data(&exact);
    let mut problem = Problem::new(&without)?;
    for other in others {
        let bound = BoundEffect::from_setting(other, &without.robot)?;
        if bound.effect.is_estimable() {
            problem.free_effects.push(bound);
        }
    }
    let left = solved(&problem)?.chi2;
    let by_truth = chi2_of_truth(&exact.truth, &without)?;
    ensure!(
        by_truth < 1.0 + 0.02 * left,
        "the truth leaves {by_truth} of {left}"
    );
    Ok(left)
}

/// Chi-square of the true model, which is large for effects beyond the validity of their own formula.
fn chi2_of_truth(truth: &Robot, data: &Dataset) -> Result<f64> {
    let data = Dataset {
        robot: Robot {
            effects: truth.effects.clone(),
            ..data.robot.clone()
        },
        measurements: data.measurements.clone(),
    };
    let mut problem = Problem::new(&data)?;
    // Effects that corrupt readings are not part of any model.
    if !problem.held_effects.iter().all(|b| b.effect.is_estimable()) {
        return Ok(0.0);
    }
    problem.geometry = Geometry::Held;
    Ok(solved(&problem)?.chi2)
}

/// Finds the size at which the noncentrality is `target`, within 5 %, starting at `size` with the noncentrality
/// `at_size`. `None` if the search fails.
pub(crate) fn size_for(
    target: f64,
    (size, at_size): (f64, f64),
    noncentrality: impl Fn(f64) -> Result<f64>,
) -> Option<f64> {
    let (mut size, mut value) = (size, at_size);
    // Noncentrality is quadratic for small effects; later steps use the observed slope.
    let mut power = 2.0;
    for _ in 0..20 {
        if !(value.is_finite() && value > 0.0) {
            return None;
        }
        if (value / target - 1.0).abs() < 0.05 {
            return Some(size);
        }
        let next = size * (target / value).powf(1.0 / power).clamp(0.05, 20.0);
        let at_next = noncentrality(next).ok()?;
        let slope = (at_next / value).ln() / (next / size).ln();
        power = if slope.is_finite() {
            slope.clamp(1.0, 5.0)
        } else {
            2.0
        };
        (size, value) = (next, at_next);
    }
    None
}

/// Every permanent effect of the catalogue on any single cable or on all cables.
pub(crate) fn single_effects(robot: &Robot) -> Vec<EffectRequest> {
    let direct = |effect: &&Effect| effect.search() == Search::Direct;
    let effects = CATALOGUE.iter().copied().filter(direct);
    effects
        .flat_map(|effect| on_each_target(effect, robot))
        .collect()
}

/// An effect on any single cable, or on all cables or the robot.
pub(crate) fn on_each_target(effect: &Effect, robot: &Robot) -> Vec<EffectRequest> {
    let names = robot.cables.iter().map(|cable| &cable.name);
    let mut targets: Vec<Vec<String>> = vec![Vec::new()];
    if effect.scope() != Scope::Robot {
        targets.extend(names.map(|name| vec![name.clone()]));
    }
    let request = |cables| EffectRequest {
        effect: effect.id().to_owned(),
        cables,
        values: Vec::new(),
    };
    targets.into_iter().map(request).collect()
}

/// Chi-square that an effect leaves unexplained; infinite if it cannot be estimated from these readings.
fn chi2_with(dataset: &Dataset, request: EffectRequest) -> Result<f64> {
    let mut problem = Problem::new(dataset)?;
    problem.free(&[request])?;
    Ok(solved(&problem).map_or(f64::INFINITY, |found| found.chi2))
}

/// Smallest chi-square that any single permanent effect of the catalogue leaves of an effect outside it. Below
/// [`VISIBLE`] the two cannot be told apart.
pub(super) fn chi2_of_nearest_effect(dataset: &Dataset) -> Result<f64> {
    let mut least = f64::INFINITY;
    for request in single_effects(&dataset.robot) {
        least = least.min(chi2_with(dataset, request)?);
    }
    Ok(least)
}

/// Effects of a cable at a pose.
const EVENTS: [&str; 3] = ["cable_slip", "frame_shift", "encoder_outlier"];

/// Smallest chi-square that any other single effect leaves of an effect. The search stops below `enough`. A permanent
/// effect is also compared with a slip of its cables at every second pose, and an event with all other events on the
/// same cable at the same pose.
pub(super) fn chi2_of_nearest_other(
    setup: &Setup,
    effect: &EffectSetting,
    enough: f64,
) -> Result<f64> {
    let dataset = setup.visibility_data(&setup.exact(std::slice::from_ref(effect))?);
    let robot = &dataset.robot;
    let mut rivals = single_effects(robot);
    // The scale of all winches has two names.
    let alike = |id: &str| id.replace("winch_scale_common", "winch_scale");
    let single = |rival: &EffectRequest| match effect.targets.as_slice() {
        [target] => rival.cables.first() == Some(target),
        _ => rival.cables.is_empty(),
    };
    rivals.retain(|rival| alike(&rival.effect) != alike(&effect.effect) || !single(rival));
    if EVENTS.contains(&effect.effect.as_str()) {
        // Other events on the same cable at the same pose.
        for id in EVENTS.iter().filter(|id| **id != effect.effect) {
            rivals.push(EffectRequest {
                effect: (*id).to_owned(),
                cables: effect.targets.first().cloned().into_iter().collect(),
                values: vec![("pose".to_owned(), effect.parameters["pose"])],
            });
        }
    } else {
        for label in dataset.measurements.labels.iter().skip(2).step_by(2) {
            for cable in &effect.targets {
                rivals.push(EffectRequest {
                    effect: "cable_slip".to_owned(),
                    cables: vec![cable.clone()],
                    values: vec![("pose".to_owned(), *label as f64)],
                });
            }
        }
    }
    let mut least = f64::INFINITY;
    for rival in rivals {
        // The effect on each cable includes the effect itself.
        let contains = alike(&rival.effect) == alike(&effect.effect) && rival.cables.is_empty();
        if !contains {
            least = least.min(chi2_with(&dataset, rival)?);
        }
        if least < enough {
            break;
        }
    }
    Ok(least)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tables::hidden::robots::robot;
    use crate::tables::hidden::{Conditions, Hidden};
    use crate::tables::simulated::setting;

    fn mini(seed: u64) -> Setup {
        Setup {
            robot: robot("mini").unwrap(),
            seed,
            conditions: Conditions::default(),
        }
    }

    fn scale(size: f64) -> EffectSetting {
        setting("winch_scale", &["cable-3"], "scale", size)
    }

    #[test]
    fn noncentrality_is_zero_without_effect_and_quadratic_in_small_ones() {
        let mini = mini(5);
        let at = |size| noncentrality(&mini, &scale(size), &[]).unwrap();
        assert!(at(0.0) < 1e-6, "{}", at(0.0));
        let (one, two) = (at(0.002), at(0.004));
        assert!(one > 1.0 && (two / one - 4.0).abs() < 0.2, "{one} {two}");
        let size = size_for(VISIBLE, (0.002, one), |s| {
            noncentrality(&mini, &scale(s), &[])
        });
        let found = at(size.unwrap());
        assert!((found / VISIBLE - 1.0).abs() < 0.05, "{found}");
    }

    #[test]
    fn estimating_a_similar_effect_reduces_the_noncentrality() {
        let mini = mini(5);
        let alone = noncentrality(&mini, &scale(0.003), &[]).unwrap();
        let same = noncentrality(&mini, &scale(0.003), &[scale(0.001)]).unwrap();
        // The other instance of the same effect explains both, apart from its prior.
        assert!(same < 0.05 * alone, "{alone} {same}");
    }

    /// The expected gain of chi-square by the effect in noisy data is its noncentrality plus 1, with a standard
    /// deviation of twice the square root of the noncentrality.
    #[test]
    fn noncentrality_is_the_expected_gain_of_noisy_data() {
        let effect = scale(0.004);
        let mut z = 0.0;
        for seed in 0..20 {
            let mini = mini(seed);
            let expected = noncentrality(&mini, &effect, &[]).unwrap();
            let hidden = Hidden::Effects(vec![effect.clone()]);
            let run = mini.measured(&hidden).unwrap();
            let base = Problem::new(&run.dataset).unwrap();
            let mut full = base.clone();
            full.free_effects
                .push(BoundEffect::from_setting(&effect, &run.dataset.robot).unwrap());
            let gain = solved(&base).unwrap().chi2 - solved(&full).unwrap().chi2;
            z += (gain - expected - 1.0) / (2.0 * expected.sqrt()) / 20.0_f64.sqrt();
        }
        // The mean of 20 standardised gains would exceed 4 standard errors by chance once in 16,000 cases.
        assert!(z.abs() < 4.0, "{z}");
    }
}

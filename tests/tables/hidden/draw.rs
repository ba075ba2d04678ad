//! Draws cases with random targets, signs and sizes.

use anyhow::{Context, Result, anyhow, bail};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};
use tautline_core::effect::{CATALOGUE, Effect, EffectSetting, find};

use super::conditions::Conditions;
use super::template::{Template, log_uniform};
use super::visibility::{JUST_VISIBLE, VISIBLE, chi2_of_nearest_effect, noncentrality, size_for};
use super::{Channels, Hidden, OUTSIDE, Plan, Setup, Stratum, Wanted, outside, several};
use crate::tables::simulated::stream;

/// Maximum number of failed draws, for example of effects that break the robot, before a plan is given up.
const MAX_DRAWS: usize = 30;
/// Noncentrality below which no reading depends on an effect.
pub(crate) const NEGLIGIBLE: f64 = 1e-3;
/// Range of noncentralities of effects outside the catalogue.
pub(crate) const OUTSIDE_SIZES: [f64; 2] = [60.0, 400.0];

/// A case, and how it was drawn.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Drawn {
    /// What is hidden.
    pub hidden: Hidden,
    /// Imperfections of the measurements.
    pub conditions: Conditions,
    /// Noncentrality of each hidden effect with the others estimated. For an effect outside the catalogue, the second
    /// value is what the nearest effect of the catalogue leaves unexplained.
    pub noncentralities: Vec<f64>,
    /// Whether the hidden effects are visible in these poses; for an effect outside the catalogue, whether it can be
    /// told from every single effect of the catalogue.
    pub visible: bool,
    /// Number of draws that were discarded because the effect broke the robot.
    pub redraws: usize,
}

/// A setting with its noncentrality.
struct Sized {
    setting: EffectSetting,
    noncentrality: f64,
    visible: bool,
}

/// Draws the case of a plan. `None` if no reading of the robot depends on the effect.
///
/// # Errors
/// If the names are unknown or nothing could be drawn that leaves the robot whole.
pub fn draw(plan: &Plan) -> Result<Option<Drawn>> {
    // The simulation uses the same seed, so the draws need another stream.
    let mut rng = stream(plan.seed, 1);
    let conditions = Conditions::draw(plan.circumstances, &mut rng);
    let setup = Setup::new(plan, conditions)?;
    let (setup, rng) = (&setup, &mut rng);
    match plan.wanted {
        Wanted::Nothing => Ok(Some(drawn(setup, Hidden::Nothing, vec![]))),
        Wanted::One(id, stratum) => {
            let effect = find(id).with_context(|| format!("no effect {id}"))?;
            one(setup, (effect, stratum), rng)
        }
        Wanted::Any => Ok(Some(drawn_effects(setup, several::one(setup, false, rng)?))),
        Wanted::Separated => Ok(Some(drawn_effects(setup, several::one(setup, true, rng)?))),
        Wanted::Two => two(setup, rng).map(Some),
        Wanted::Several => Ok(Some(drawn_effects(setup, several::several(setup, rng)?))),
        Wanted::ByChance => Ok(Some(drawn_effects(setup, several::by_chance(setup, rng)?))),
        Wanted::CommonOffset => Ok(Some(drawn_effects(
            setup,
            several::common_offset(setup, rng)?,
        ))),
        Wanted::Families => Ok(Some(drawn_effects(setup, several::families(setup, rng)))),
        Wanted::Exchanged(channels) => Ok(exchanged(setup, channels, rng)),
        Wanted::Outside(id) => {
            let found = OUTSIDE.iter().find(|o| o.id == id);
            let effect = found.with_context(|| format!("no effect {id} outside the catalogue"))?;
            if !(effect.applies)(&setup.robot.preset.robot) {
                return Ok(None);
            }
            outside_case(setup, effect, rng).map(Some)
        }
    }
}

/// A case whose hidden effects are all visible.
fn drawn(setup: &Setup, hidden: Hidden, noncentralities: Vec<f64>) -> Drawn {
    Drawn {
        hidden,
        conditions: setup.conditions,
        noncentralities,
        visible: true,
        redraws: 0,
    }
}

fn drawn_effects(setup: &Setup, (effects, seen): several::DrawnEffects) -> Drawn {
    let visible = seen.iter().all(|value| *value >= VISIBLE);
    Drawn {
        visible,
        ..drawn(setup, Hidden::Effects(effects), seen)
    }
}

fn exchanged(setup: &Setup, channels: Channels, rng: &mut ChaCha8Rng) -> Option<Drawn> {
    let robot = &setup.robot.preset.robot;
    let count = robot.cable_count();
    let one = rng.random_range(0..count);
    let other = (one + rng.random_range(1..count)) % count;
    let hidden = Hidden::Exchanged(channels, [one, other]);
    channels
        .exist_on(robot)
        .then(|| drawn(setup, hidden, vec![]))
}

fn one(
    setup: &Setup,
    (effect, stratum): (&'static Effect, Stratum),
    rng: &mut ChaCha8Rng,
) -> Result<Option<Drawn>> {
    let mut last = anyhow!("nothing was tried");
    for redraws in 0..MAX_DRAWS {
        let template = Template::draw(effect, &setup.robot, rng);
        match sized(setup, (&template, stratum), rng) {
            Ok(sized) if sized.noncentrality < NEGLIGIBLE => return Ok(None),
            Ok(sized) => {
                let hidden = Hidden::Effects(vec![sized.setting]);
                return Ok(Some(Drawn {
                    visible: sized.visible,
                    redraws,
                    ..drawn(setup, hidden, vec![sized.noncentrality])
                }));
            }
            Err(error) => last = error,
        }
    }
    Err(last)
}

/// Chooses a size for a template. A template that is not visible even at its largest typical size gets that size.
fn sized(
    setup: &Setup,
    (template, stratum): (&Template, Stratum),
    rng: &mut ChaCha8Rng,
) -> Result<Sized> {
    let at = |size: f64| noncentrality(setup, &template.setting(size), &[]);
    let Some([smallest, largest]) = template.typical else {
        let noncentrality = at(0.0)?;
        return Ok(Sized {
            setting: template.setting(0.0),
            noncentrality,
            visible: noncentrality >= VISIBLE,
        });
    };
    let (largest, most) = largest_possible([smallest, largest], &at)?;
    let found = |target: f64| {
        size_for(target, (largest, most), at).context("no size has the noncentrality wanted")
    };
    let size = match stratum {
        _ if most < VISIBLE => largest,
        Stratum::JustVisible => found(log_uniform(JUST_VISIBLE, rng).min(most))?,
        Stratum::Typical => {
            let visible = at(smallest).is_ok_and(|least| least >= VISIBLE);
            let from = if visible { smallest } else { found(VISIBLE)? };
            log_uniform([from.min(largest), largest], rng)
        }
    };
    Ok(Sized {
        setting: template.setting(size),
        noncentrality: at(size)?,
        visible: most >= VISIBLE,
    })
}

/// The largest typical size, or the largest size below it that does not break the robot, and its noncentrality.
fn largest_possible(
    [smallest, largest]: [f64; 2],
    noncentrality: &impl Fn(f64) -> Result<f64>,
) -> Result<(f64, f64)> {
    let mut size = largest;
    loop {
        match noncentrality(size) {
            Ok(value) => return Ok((size, value)),
            Err(error) if size < 1.5 * smallest => return Err(error),
            Err(_) => size = (0.6 * size).max(smallest),
        }
    }
}

/// Draws two effects, each visible while the other is estimated.
fn two(setup: &Setup, rng: &mut ChaCha8Rng) -> Result<Drawn> {
    // The noncentrality of one effect is computed with the other estimated, so both must be estimable.
    let estimable: Vec<_> = CATALOGUE.iter().filter(|e| e.is_estimable()).collect();
    for redraws in 0..20 * MAX_DRAWS {
        let mut settings = Vec::new();
        for _ in 0..2 {
            let effect = *estimable[rng.random_range(0..estimable.len())];
            let template = Template::draw(effect, &setup.robot, rng);
            if let Ok(sized) = sized(setup, (&template, Stratum::Typical), rng)
                && sized.visible
            {
                settings.push(sized.setting);
            }
        }
        let [one, other] = settings.as_slice() else {
            continue;
        };
        let both = [(one, other), (other, one)].map(|(effect, beside)| {
            let beside = std::slice::from_ref(beside);
            noncentrality(setup, effect, beside).unwrap_or(0.0)
        });
        if both.iter().all(|value| *value >= VISIBLE) {
            let hidden = Hidden::Effects(settings);
            return Ok(Drawn {
                redraws,
                ..drawn(setup, hidden, both.to_vec())
            });
        }
    }
    bail!("no two effects found for {}", setup.robot.name)
}

fn outside_case(
    setup: &Setup,
    effect: &'static outside::Outside,
    rng: &mut ChaCha8Rng,
) -> Result<Drawn> {
    let target = log_uniform(OUTSIDE_SIZES, rng);
    let exact = setup.exact(&[])?;
    let at = |size: f64| outside::noncentrality(setup, &exact, (effect, size));
    let first = at(effect.unit)?;
    let size = size_for(target, (effect.unit, first), at)
        .with_context(|| format!("no size of {} is visible", effect.id))?;
    let left = chi2_of_nearest_effect(&outside::changed(setup, &exact, (effect, size)))?;
    Ok(Drawn {
        visible: left >= VISIBLE,
        ..drawn(setup, Hidden::Outside(effect, size), vec![at(size)?, left])
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tables::hidden::Circumstances;

    fn plan(robot: &'static str, wanted: Wanted) -> Plan {
        Plan {
            robot,
            seed: 3,
            wanted,
            circumstances: Circumstances::AsStated,
        }
    }

    #[test]
    fn visibility_of_sizes_is_reported() {
        for stratum in [Stratum::Typical, Stratum::JustVisible] {
            let wanted = Wanted::One("winch_scale", stratum);
            let drawn = draw(&plan("mini", wanted)).unwrap().unwrap();
            assert!(drawn.visible);
            let value = drawn.noncentralities[0];
            let [low, high] = JUST_VISIBLE;
            match stratum {
                Stratum::Typical => assert!(value > 0.9 * VISIBLE, "{value}"),
                Stratum::JustVisible => assert!(value > 0.9 * low && value < 1.1 * high),
            }
        }
        // A steel frame warms by less than a kelvin, which is not visible.
        let wanted = Wanted::One("frame_thermal", Stratum::Typical);
        let drawn = draw(&plan("mini", wanted)).unwrap().unwrap();
        assert!(!drawn.visible && drawn.noncentralities[0] < VISIBLE);
    }

    #[test]
    fn effects_without_readings_give_no_case() {
        for id in ["swivel_offset", "inclinometer_tilt"] {
            let wanted = Wanted::One(id, Stratum::Typical);
            assert_eq!(draw(&plan("mini", wanted)).unwrap(), None);
        }
        let wanted = Wanted::One("force_bias", Stratum::Typical);
        assert_eq!(draw(&plan("mini-forceless", wanted)).unwrap(), None);
    }

    #[test]
    fn draws_are_repeatable() {
        let wanted = Wanted::One("drum_eccentricity", Stratum::Typical);
        let plan = plan("planar", wanted);
        assert_eq!(draw(&plan).unwrap(), draw(&plan).unwrap());
    }

    #[test]
    fn two_effects_are_each_visible_beside_the_other() {
        let drawn = draw(&plan("planar", Wanted::Two)).unwrap().unwrap();
        assert_eq!(drawn.noncentralities.len(), 2);
        assert!(drawn.noncentralities.iter().all(|v| *v >= VISIBLE));
    }
}

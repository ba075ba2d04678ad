//! Cases with random targets, signs and sizes.

use anyhow::{Context, Result, anyhow, bail};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use tautline_core::effect::{CATALOGUE, Effect, EffectSetting, find};

use super::outside::{self, Scene};
use super::robots::{TestRobot, robot};
use super::template::{Template, log_uniform};
use super::visibility::{JUST_VISIBLE, VISIBLE, left_by_nearest, noncentrality, size_for};
use super::{Case, Hidden, OUTSIDE, Plan, Stratum, Wanted};

/// Draws that may fail, as when an effect breaks the robot, before a plan is given up.
const TRIES: usize = 30;
/// Noncentrality below which no reading depends on an effect.
const NOTHING: f64 = 1e-3;
/// Noncentralities of effects outside the catalogue.
const OUTSIDE_SIZES: [f64; 2] = [60.0, 400.0];

/// A case and how it came about.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawn {
    /// The case.
    pub case: Case,
    /// Noncentrality of each hidden effect, the others estimated. Of one outside the catalogue, what the nearest
    /// effect in it leaves comes second.
    pub noncentralities: Vec<f64>,
    /// Whether what is hidden can be seen in these poses; outside the catalogue, whether it can be told from
    /// every single effect in it.
    pub visible: bool,
    /// Draws that were thrown away because the effect broke the robot.
    pub redraws: usize,
}

/// A template with a size.
struct Sized {
    setting: EffectSetting,
    noncentrality: f64,
    visible: bool,
}

/// Makes a case of a plan. `None` if no reading of the robot depends on the effect.
///
/// # Errors
/// If the names are unknown or nothing could be drawn that leaves the robot whole.
pub fn draw(plan: &Plan) -> Result<Option<Drawn>> {
    let robot = robot(plan.robot).with_context(|| format!("no robot {}", plan.robot))?;
    let mut rng = ChaCha8Rng::seed_from_u64(plan.seed);
    // Another stream than that of the simulation, which has the same seed.
    rng.set_stream(1);
    match plan.wanted {
        Wanted::Nothing => Ok(Some(drawn(plan, Hidden::Nothing, vec![], true, 0))),
        Wanted::One(id, stratum) => {
            let effect = find(id).with_context(|| format!("no effect {id}"))?;
            one(plan, &robot, (effect, stratum), &mut rng)
        }
        Wanted::Two => two(plan, &robot, &mut rng).map(Some),
        Wanted::Outside(id) => {
            let found = OUTSIDE.iter().find(|o| o.id == id);
            let effect = found.with_context(|| format!("no effect {id} outside the catalogue"))?;
            if !(effect.applies)(&robot.preset.robot) {
                return Ok(None);
            }
            outside_case(plan, &robot, effect, &mut rng).map(Some)
        }
    }
}

fn drawn(plan: &Plan, hidden: Hidden, sizes: Vec<f64>, visible: bool, redraws: usize) -> Drawn {
    Drawn {
        case: Case {
            robot: plan.robot,
            seed: plan.seed,
            hidden,
        },
        noncentralities: sizes,
        visible,
        redraws,
    }
}

fn one(
    plan: &Plan,
    robot: &TestRobot,
    (effect, stratum): (&'static Effect, Stratum),
    rng: &mut ChaCha8Rng,
) -> Result<Option<Drawn>> {
    let mut last = anyhow!("nothing was tried");
    for redraws in 0..TRIES {
        let template = Template::draw(effect, &robot.preset.robot, rng);
        match sized(plan, robot, (&template, stratum), rng) {
            Ok(sized) if sized.noncentrality < NOTHING => return Ok(None),
            Ok(sized) => {
                let hidden = Hidden::Effects(vec![sized.setting]);
                let sizes = vec![sized.noncentrality];
                return Ok(Some(drawn(plan, hidden, sizes, sized.visible, redraws)));
            }
            Err(error) => last = error,
        }
    }
    Err(last)
}

/// Gives a template a size. One that cannot be seen at the largest typical size has that size.
fn sized(
    plan: &Plan,
    robot: &TestRobot,
    (template, stratum): (&Template, Stratum),
    rng: &mut ChaCha8Rng,
) -> Result<Sized> {
    let at = |size: f64| noncentrality(robot, plan.seed, &template.setting(size), &[]);
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

/// The largest typical size, or the largest below it that leaves the robot whole, and its noncentrality.
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

/// Two effects, each visible while the other is estimated.
fn two(plan: &Plan, robot: &TestRobot, rng: &mut ChaCha8Rng) -> Result<Drawn> {
    // What is not estimable cannot be allowed for while the other is judged.
    let estimable: Vec<_> = CATALOGUE.iter().filter(|e| e.is_estimable()).collect();
    for redraws in 0..20 * TRIES {
        let mut settings = Vec::new();
        for _ in 0..2 {
            let effect = *estimable[rng.random_range(0..estimable.len())];
            let template = Template::draw(effect, &robot.preset.robot, rng);
            if let Ok(sized) = sized(plan, robot, (&template, Stratum::Typical), rng)
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
            noncentrality(robot, plan.seed, effect, beside).unwrap_or(0.0)
        });
        if both.iter().all(|value| *value >= VISIBLE) {
            let hidden = Hidden::Effects(settings);
            return Ok(drawn(plan, hidden, both.to_vec(), true, redraws));
        }
    }
    bail!("no two effects found for {plan:?}")
}

fn outside_case(
    plan: &Plan,
    robot: &TestRobot,
    effect: &'static outside::Outside,
    rng: &mut ChaCha8Rng,
) -> Result<Drawn> {
    let target = log_uniform(OUTSIDE_SIZES, rng);
    let exact = super::visibility::simulated(robot, plan.seed, &[], false)?;
    let scene = Scene::new(&exact.truth, plan.seed);
    let at = |size: f64| outside::noncentrality(&scene, &exact, (effect, size));
    let first = at(effect.unit)?;
    let size = size_for(target, (effect.unit, first), at)
        .with_context(|| format!("no size of {} is visible on {}", effect.id, plan.robot))?;
    let hidden = Hidden::Outside(effect, size);
    let left = left_by_nearest(&outside::changed(&scene, &exact, (effect, size)))?;
    let sizes = vec![at(size)?, left];
    Ok(drawn(plan, hidden, sizes, left >= VISIBLE, 0))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plan(robot: &'static str, wanted: Wanted) -> Plan {
        Plan {
            robot,
            seed: 3,
            wanted,
        }
    }

    #[test]
    fn sizes_are_visible_or_said_not_to_be() {
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
        // A steel frame that warms by less than a kelvin.
        let wanted = Wanted::One("frame_thermal", Stratum::Typical);
        let drawn = draw(&plan("mini", wanted)).unwrap().unwrap();
        assert!(!drawn.visible && drawn.noncentralities[0] < VISIBLE);
    }

    #[test]
    fn what_no_reading_depends_on_is_no_case() {
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

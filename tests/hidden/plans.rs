//! Which data sets a study makes.

use tautline_core::effect::CATALOGUE;

use super::{OUTSIDE, Plan, Stratum, Wanted, robots};

/// Seed of the first data set.
const FIRST_SEED: u64 = 500_000;
/// Of this many data sets per effect and robot the last is just visible.
const JUST_VISIBLE_EVERY: usize = 3;

/// What a study is restricted to.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Restriction {
    /// Robot.
    pub robot: Option<String>,
    /// Effect.
    pub effect: Option<String>,
    /// Seed of the only data set of each kind.
    pub seed: Option<u64>,
}

impl Restriction {
    fn allows(&self, plan: &Plan) -> bool {
        let is = |wanted: &Option<String>, name: &str| wanted.as_deref().is_none_or(|w| w == name);
        let effect = match plan.wanted {
            Wanted::One(id, _) | Wanted::Outside(id) => Some(id),
            Wanted::Nothing | Wanted::Two => None,
        };
        is(&self.robot, plan.robot)
            && effect.is_none_or(|id| is(&self.effect, id))
            && self.seed.is_none_or(|seed| seed == plan.seed)
    }

    /// Numbers seeds, whatever is left out later, and applies the restriction.
    fn plans(&self, wanted: impl Iterator<Item = (&'static str, Wanted)>) -> Vec<Plan> {
        let plans = wanted.enumerate().map(|(n, (robot, wanted))| Plan {
            robot,
            seed: self.seed.unwrap_or(FIRST_SEED + n as u64),
            wanted,
        });
        let mut plans: Vec<Plan> = plans.filter(|plan| self.allows(plan)).collect();
        if self.seed.is_some() {
            // With one seed, repetitions are the same data set.
            let mut unique: Vec<Plan> = Vec::new();
            plans.retain(|plan| {
                let new = !unique.contains(plan);
                unique.push(*plan);
                new
            });
        }
        plans
    }
}

fn names() -> Vec<&'static str> {
    robots().iter().map(|robot| robot.name).collect()
}

/// Every effect of the catalogue on every robot, `count` times, every third time just visible.
#[must_use]
pub fn single(count: usize, restriction: &Restriction) -> Vec<Plan> {
    let stratum = |repetition: usize| match (repetition + 1) % JUST_VISIBLE_EVERY {
        0 => Stratum::JustVisible,
        _ => Stratum::Typical,
    };
    let mut wanted = Vec::new();
    for repetition in 0..count {
        for robot in names() {
            for effect in CATALOGUE {
                wanted.push((robot, Wanted::One(effect.id(), stratum(repetition))));
            }
        }
    }
    restriction.plans(wanted.into_iter())
}

/// Random pairs of effects, `count` on every robot.
#[must_use]
pub fn pairs(count: usize, restriction: &Restriction) -> Vec<Plan> {
    let each = (0..count).flat_map(|_| names());
    restriction.plans(each.map(|robot| (robot, Wanted::Two)))
}

/// Data without hidden effect, `count` in all, the robots in turn.
#[must_use]
pub fn clean(count: usize, restriction: &Restriction) -> Vec<Plan> {
    let each = names().into_iter().cycle().take(count);
    restriction.plans(each.map(|robot| (robot, Wanted::Nothing)))
}

/// Every effect outside the catalogue on every robot, `count` times.
#[must_use]
pub fn outside(count: usize, restriction: &Restriction) -> Vec<Plan> {
    let mut wanted = Vec::new();
    for _ in 0..count {
        for robot in names() {
            for effect in &OUTSIDE {
                wanted.push((robot, Wanted::Outside(effect.id)));
            }
        }
    }
    restriction.plans(wanted.into_iter())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_restriction_picks_out_the_same_data_set() {
        let all = single(3, &Restriction::default());
        assert_eq!(all.len(), 3 * robots().len() * CATALOGUE.len());
        let plan = all[500];
        let Wanted::One(effect, _) = plan.wanted else {
            unreachable!("a study of single effects");
        };
        let only = single(
            3,
            &Restriction {
                robot: Some(plan.robot.to_owned()),
                effect: Some(effect.to_owned()),
                seed: Some(plan.seed),
            },
        );
        assert_eq!(only.len(), 2, "one of each stratum");
        assert!(only.contains(&plan));
    }
}

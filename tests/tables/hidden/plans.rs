//! Selects the datasets of a study.

use std::collections::BTreeSet;

use tautline_core::effect::{CATALOGUE, Effect};

use super::{Channels, Circumstances, OUTSIDE, Plan, Stratum, Wanted, robots};

/// Seed of the first dataset.
const FIRST_SEED: u64 = 4_000_000;
/// One in this many datasets per effect and robot is just visible.
const JUST_VISIBLE_EVERY: usize = 3;

/// Restricts a study to some of its datasets.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Restriction {
    /// Robot.
    pub robot: Option<String>,
    /// Effect.
    pub effect: Option<String>,
    /// Seed to be used for all datasets instead of consecutive ones.
    pub seed: Option<u64>,
}

impl Restriction {
    fn allows(&self, plan: &Plan) -> bool {
        let is = |wanted: &Option<String>, name: &str| wanted.as_deref().is_none_or(|w| w == name);
        let effect = match plan.wanted {
            Wanted::One(id, _) | Wanted::Outside(id) => Some(id),
            _ => None,
        };
        is(&self.robot, plan.robot)
            && effect.is_none_or(|id| is(&self.effect, id))
            && self.seed.is_none_or(|seed| seed == plan.seed)
    }

    /// Numbers the seeds before applying the restriction, so that a dataset keeps its seed.
    fn plans(&self, wanted: impl IntoIterator<Item = (&'static str, Wanted)>) -> Vec<Plan> {
        let plans = wanted
            .into_iter()
            .enumerate()
            .map(|(n, (robot, wanted))| Plan {
                robot,
                seed: self.seed.unwrap_or(FIRST_SEED + n as u64),
                wanted,
                circumstances: Circumstances::AsStated,
            });
        let mut plans: Vec<Plan> = plans.filter(|plan| self.allows(plan)).collect();
        if self.seed.is_some() {
            // With a single seed, repetitions would be identical.
            let mut seen = BTreeSet::new();
            plans.retain(|plan| seen.insert(*plan));
        }
        plans
    }
}

fn names() -> Vec<&'static str> {
    robots().iter().map(|robot| robot.name).collect()
}

/// Every effect of the catalogue on every robot, `count` times; every third time it is just visible.
#[must_use]
pub fn single(count: usize, restriction: &Restriction) -> Vec<Plan> {
    let stratum = |repetition: usize| match (repetition + 1) % JUST_VISIBLE_EVERY {
        0 => Stratum::JustVisible,
        _ => Stratum::Typical,
    };
    restriction.plans(on_every_robot(count, |repetition| {
        let one = |effect: &&Effect| Wanted::One(effect.id(), stratum(repetition));
        CATALOGUE.iter().map(one).collect()
    }))
}

/// All that is wanted on every robot, `count` times.
fn on_every_robot(
    count: usize,
    wanted: impl Fn(usize) -> Vec<Wanted>,
) -> Vec<(&'static str, Wanted)> {
    let mut all = Vec::new();
    for repetition in 0..count {
        for robot in names() {
            all.extend(wanted(repetition).into_iter().map(|wanted| (robot, wanted)));
        }
    }
    all
}

/// Random pairs of effects, `count` for every robot.
#[must_use]
pub fn pairs(count: usize, restriction: &Restriction) -> Vec<Plan> {
    restriction.plans(on_every_robot(count, |_| vec![Wanted::Two]))
}

/// Datasets without a hidden effect, `count` in all, distributed over the robots.
#[must_use]
pub fn clean(count: usize, restriction: &Restriction) -> Vec<Plan> {
    let each = names().into_iter().cycle().take(count);
    restriction.plans(each.map(|robot| (robot, Wanted::Nothing)))
}

/// Every effect outside the catalogue on every robot, `count` times.
#[must_use]
pub fn outside(count: usize, restriction: &Restriction) -> Vec<Plan> {
    let effects = OUTSIDE.iter().map(|effect| Wanted::Outside(effect.id));
    restriction.plans(on_every_robot(count, |_| effects.clone().collect()))
}

/// Circumstances in which only the noise may deviate.
const NOISES: [Circumstances; 2] = [Circumstances::AsStated, Circumstances::OtherNoise];

/// Names and descriptions of the studies.
pub const STUDIES: [(&str, &str); 13] = [
    (
        "several",
        "three to five effects at once, noise 0.5 to 2 times as stated, 60 poses",
    ),
    ("separated", "one effect that no other could be taken for"),
    ("nothing", "nothing, measured as stated"),
    ("unknown", "effects that the catalogue does not have"),
    (
        "anything",
        "one visible effect, or nothing, noise 0.5 to 2 times as stated",
    ),
    (
        "mild",
        "the model slightly wrong everywhere, with and without one effect",
    ),
    (
        "dominating",
        "one large offset of all cables, anchors unknown",
    ),
    (
        "families",
        "every winch and every force sensor with errors of its own",
    ),
    ("exchanged", "two channels the wrong way round"),
    ("holes", "empty cells"),
    ("tails", "heavy tails, with and without one effect"),
    (
        "standstills",
        "rows that share errors, with and without one effect",
    ),
    ("chance", "as many effects as chance has it"),
];

/// First seed of the published table. Development must use other seeds.
pub const TABLE_SEED: u64 = 90_000_000;
/// Distance between the first seeds of two studies of the table.
const SEED_STRIDE: u64 = 100_000;
/// Number of datasets in each study of the table.
const TABLE: [(&str, usize); 13] = [
    ("several", 400),
    ("separated", 252),
    ("nothing", 1000),
    ("unknown", 288),
    ("anything", 216),
    ("mild", 216),
    ("dominating", 100),
    ("families", 50),
    ("exchanged", 108),
    ("holes", 200),
    ("tails", 144),
    ("standstills", 144),
    ("chance", 216),
];

/// Datasets of the table. The studies are interleaved, so that an interrupted run still gives a complete table with
/// wider intervals.
#[must_use]
pub fn table_plans(only: &Restriction) -> Vec<Plan> {
    let studies = (TABLE_SEED..).step_by(SEED_STRIDE as usize).zip(TABLE);
    let mut placed: Vec<(f64, Plan)> = Vec::new();
    for (first, (study, count)) in studies {
        let plans = named(study, count, first, only).unwrap_or_default();
        let place = |k: usize| (k as f64 + 0.5) / count as f64;
        placed.extend(
            plans
                .into_iter()
                .enumerate()
                .map(|(k, plan)| (place(k), plan)),
        );
    }
    placed.sort_by(|a, b| a.0.total_cmp(&b.0));
    placed.into_iter().map(|(_, plan)| plan).collect()
}

/// The first `count` datasets of the study `study` in [`STUDIES`], cycling through the robots, with consecutive seeds
/// from `first_seed` on. `None` if there is no such study.
#[must_use]
pub fn named(study: &str, count: usize, first_seed: u64, only: &Restriction) -> Option<Vec<Plan>> {
    use Circumstances as C;
    use Wanted as W;
    let exchanged = Channels::ALL.map(|channels| (W::Exchanged(channels), C::AsStated));
    let kinds: Vec<(Wanted, Circumstances)> = match study {
        "several" => vec![(W::Several, C::OtherNoise)],
        "separated" => vec![(W::Separated, C::AsStated)],
        "nothing" => vec![(W::Nothing, C::AsStated)],
        "unknown" => (OUTSIDE.iter())
            .map(|effect| (W::Outside(effect.id), C::AsStated))
            .collect(),
        "anything" => vec![(W::Any, C::OtherNoise), (W::Nothing, C::OtherNoise)],
        "mild" => vec![(W::Any, C::ModelError), (W::Nothing, C::ModelError)],
        "dominating" => vec![(W::CommonOffset, C::ModelError)],
        "families" => vec![(W::Families, C::AsStated)],
        "exchanged" => exchanged.to_vec(),
        "holes" => vec![(W::Any, C::Holes)],
        "tails" => vec![(W::Any, C::HeavyTails), (W::Nothing, C::HeavyTails)],
        "standstills" => vec![(W::Any, C::Standstills), (W::Nothing, C::Standstills)],
        "chance" => NOISES.map(|noise| (W::ByChance, noise)).to_vec(),
        _ => return None,
    };
    let all = match study {
        "dominating" => vec!["planar-unmeasured"],
        "families" => vec!["hanging"],
        _ => names(),
    };
    let chosen = |name: &&'static str| only.robot.as_deref().is_none_or(|robot| robot == *name);
    let all: Vec<_> = all.into_iter().filter(chosen).collect();
    let plan = |n: usize| Plan {
        robot: all[n / kinds.len() % all.len()],
        seed: first_seed + n as u64,
        wanted: kinds[n % kinds.len()].0,
        circumstances: kinds[n % kinds.len()].1,
    };
    let count = if all.is_empty() { 0 } else { count };
    Some((0..count).map(plan).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn studies_have_their_names_and_take_all_robots() {
        for ((name, _), (of_table, _)) in STUDIES.into_iter().zip(TABLE) {
            assert_eq!(name, of_table);
            assert!(
                named(name, 3, 7, &Restriction::default()).is_some_and(|plans| plans.len() == 3)
            );
        }
        assert_eq!(
            named("nothing of the kind", 1, 1, &Restriction::default()),
            None
        );
        let plans = named("mild", 18, 600_000, &Restriction::default()).unwrap();
        for name in names() {
            assert_eq!(plans.iter().filter(|plan| plan.robot == name).count(), 2);
        }
        let only = Restriction {
            robot: Some("hall".to_owned()),
            ..Restriction::default()
        };
        let plans = named("tails", 4, 600_000, &only).unwrap();
        assert!(plans.iter().all(|plan| plan.robot == "hall"));
        assert_eq!(plans[3].seed, 600_003);
    }

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

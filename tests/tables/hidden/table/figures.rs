//! Figures of a study with their requirements.

use std::fmt;

use super::{
    found, has_finding_without_wrong_name, is_found, is_noticed_without_wrong_name, is_outside,
    typical,
};
use crate::tables::hidden::interval::{binomial_tail, clopper_pearson};
use crate::tables::hidden::judge::Found;
use crate::tables::hidden::{Circumstances, FindingRecord, Outcome, Stratum, Study, Sure, Wanted};

/// Half-width of a 95 % interval in standard deviations.
pub(super) const NORMAL_95: f64 = 1.959_964;
/// Required held-out error relative to that of the true model.
const HELD_OUT: f64 = 1.05;

/// Required share.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Target {
    /// At least this share.
    AtLeast(f64),
    /// At most this share.
    AtMost(f64),
    /// A share in this range.
    Within(f64, f64),
}

impl fmt::Display for Target {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::AtLeast(p) => write!(f, "at least {} %", 100.0 * p),
            Self::AtMost(p) => write!(f, "at most {} %", 100.0 * p),
            Self::Within(low, high) => write!(f, "{} to {} %", 100.0 * low, 100.0 * high),
        }
    }
}

/// A count with its requirement.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// What is counted.
    pub what: &'static str,
    /// The count.
    pub count: usize,
    /// Total number.
    pub of: usize,
    /// Required share, if any.
    pub target: Option<Target>,
}

impl Figure {
    /// Share of the total number.
    #[must_use]
    pub fn share(&self) -> f64 {
        self.count as f64 / self.of.max(1) as f64
    }

    /// 95 % interval of the share.
    #[must_use]
    pub fn interval(&self) -> [f64; 2] {
        clopper_pearson(self.count, self.of)
    }

    /// Probability of a count at least as bad if the true share just met the requirement.
    #[must_use]
    pub fn p_value(&self) -> f64 {
        let at_least = |p: f64| binomial_tail(self.of, self.of - self.count, 1.0 - p);
        let at_most = |p: f64| binomial_tail(self.of, self.count, p);
        match self.target {
            None => 1.0,
            Some(Target::AtLeast(p)) => at_least(p),
            Some(Target::AtMost(p)) => at_most(p),
            Some(Target::Within(low, high)) => at_least(low).min(at_most(high)),
        }
    }
}

/// All figures of a study.
#[derive(Debug, Clone, PartialEq)]
pub struct Figures {
    /// The figures in order; those without cases have `of` 0.
    pub all: Vec<Figure>,
}

/// Counts the outcomes for which `count` holds among those for which `pick` holds.
fn figure(
    study: &Study,
    (what, target): (&'static str, Option<Target>),
    pick: impl Fn(&Outcome) -> bool,
    count: impl Fn(&Outcome) -> bool,
) -> Figure {
    let picked: Vec<&Outcome> = study.outcomes.iter().filter(|o| pick(o)).collect();
    Figure {
        what,
        count: picked.iter().filter(|o| count(o)).count(),
        of: picked.len(),
        target,
    }
}

impl Figures {
    /// Computes the figures of a study.
    #[must_use]
    pub fn of(study: &Study) -> Self {
        let mut all = singles(study);
        all.extend(others(study));
        all.extend(several_effects(study));
        all.extend(wrong_models(study));
        all.extend(numbers(study));
        Self { all }
    }
}

fn just_visible(o: &Outcome) -> bool {
    o.drawn.visible && matches!(o.plan.wanted, Wanted::One(_, Stratum::JustVisible))
}

fn not_visible(o: &Outcome) -> bool {
    !o.drawn.visible && matches!(o.plan.wanted, Wanted::One(..))
}

/// Whether a wrong effect is named and a hidden one is not found.
fn wrong(o: &Outcome) -> bool {
    !found(o) && !o.wrong_names.is_empty()
}

fn right_with_wrong_name(o: &Outcome) -> bool {
    found(o) && !o.wrong_names.is_empty()
}

fn singles(study: &Study) -> Vec<Figure> {
    let named = |o: &Outcome| o.found == [Found::Named];
    let silent = |o: &Outcome| o.said.is_empty();
    let figure = |what, target, pick: fn(&Outcome) -> bool, count: &dyn Fn(&Outcome) -> bool| {
        figure(study, (what, target), pick, count)
    };
    let most = |p| Some(Target::AtMost(p));
    vec![
        figure(
            "typical size: named, or listed among at most three that fit as well",
            Some(Target::AtLeast(0.97)),
            typical,
            &found,
        ),
        figure("typical size: named alone", None, typical, &named),
        figure(
            "typical size: another named with confidence",
            most(0.005),
            typical,
            &wrong,
        ),
        figure(
            "typical size: right, and a wrong name besides",
            None,
            typical,
            &right_with_wrong_name,
        ),
        figure("just visible: named or listed", None, just_visible, &found),
        figure(
            "just visible: another named with confidence",
            None,
            just_visible,
            &wrong,
        ),
        figure("just visible: nothing said", None, just_visible, &silent),
        figure("not visible: nothing said", None, not_visible, &silent),
        figure(
            "not visible: another named with confidence",
            None,
            not_visible,
            &wrong,
        ),
    ]
}

fn others(study: &Study) -> Vec<Figure> {
    let clean = |o: &Outcome| {
        o.plan.wanted == Wanted::Nothing && o.plan.circumstances == Circumstances::AsStated
    };
    let two = |o: &Outcome| o.plan.wanted == Wanted::Two;
    let any = |o: &Outcome| !o.said.is_empty();
    let named = |o: &Outcome| !o.wrong_names.is_empty();
    let figure = |what, target, pick: fn(&Outcome) -> bool, count: fn(&Outcome) -> bool| {
        figure(study, (what, Some(target)), pick, count)
    };
    vec![
        figure("clean data: any finding", Target::AtMost(0.01), clean, any),
        figure(
            "outside the catalogue: unknown or ambiguous",
            Target::AtLeast(0.9),
            is_outside,
            has_finding_without_wrong_name,
        ),
        figure(
            "outside the catalogue: unknown, ambiguous or noisier than described",
            Target::AtLeast(0.9),
            is_outside,
            is_noticed_without_wrong_name,
        ),
        figure(
            "outside the catalogue: named with confidence",
            Target::AtMost(0.03),
            is_outside,
            named,
        ),
        figure(
            "two effects: both named or listed",
            Target::AtLeast(0.9),
            two,
            found,
        ),
        figure(
            "two effects: another named with confidence",
            Target::AtMost(0.005),
            two,
            named,
        ),
    ]
}

/// Counts single effects among the outcomes for which `pick` holds.
fn each_effect(
    study: &Study,
    (what, target): (&'static str, Target),
    pick: impl Fn(&Outcome) -> bool,
    count: fn(&Found) -> bool,
) -> Figure {
    let picked = study.outcomes.iter().filter(|o| pick(o));
    let all: Vec<Found> = picked.flat_map(|o| o.found.clone()).collect();
    Figure {
        what,
        count: all.iter().filter(|found| count(found)).count(),
        of: all.len(),
        target: Some(target),
    }
}

/// Figures for several effects at once, families, exchanged channels and dominating effects.
fn several_effects(study: &Study) -> Vec<Figure> {
    let several = |o: &Outcome| o.plan.wanted == Wanted::Several;
    let separated = |o: &Outcome| o.plan.wanted == Wanted::Separated;
    let families = |o: &Outcome| o.plan.wanted == Wanted::Families;
    let offset = |o: &Outcome| o.plan.wanted == Wanted::CommonOffset && o.drawn.visible;
    let exchanged = |o: &Outcome| matches!(o.plan.wanted, Wanted::Exchanged(_));
    let named = |found: &Found| *found == Found::Named;
    let named_alone = |o: &Outcome| o.found == [Found::Named] && o.said.len() == 1;
    let wrong = |o: &Outcome| !o.wrong_names.is_empty();
    let first = |o: &Outcome| {
        let first = o.said.first();
        let right = |said: &FindingRecord| said.candidates.first().is_some_and(|c| c.right);
        first.is_some_and(|said| said.sure == Sure::Named && right(said))
    };
    let least = Target::AtLeast;
    let most = Target::AtMost;
    let of = |what, target, pick: fn(&Outcome) -> bool, count: fn(&Outcome) -> bool| {
        figure(study, (what, Some(target)), pick, count)
    };
    vec![
        of(
            "separated by exact evidence: named alone",
            least(0.95),
            separated,
            named_alone,
        ),
        of(
            "separated by exact evidence: a wrong name",
            most(0.003),
            separated,
            wrong,
        ),
        each_effect(
            study,
            ("three to five effects: named", least(0.9)),
            several,
            named,
        ),
        each_effect(
            study,
            ("three to five effects: named or listed", least(0.98)),
            several,
            is_found,
        ),
        of(
            "three to five effects: a wrong name",
            most(0.02),
            several,
            wrong,
        ),
        of(
            "three to five effects: `unknown` for no reason",
            most(0.02),
            several,
            Outcome::unknown_without_reason,
        ),
        of("dominating offset: named first", least(0.95), offset, first),
        each_effect(
            study,
            ("families: members named", least(0.9)),
            families,
            named,
        ),
        of("exchanged channels: named", least(1.0), exchanged, |o| {
            o.found == [Found::Named]
        }),
        of(
            "exchanged channels: within 2 s",
            least(1.0),
            exchanged,
            |o| o.seconds < 2.0,
        ),
    ]
}

/// Figures for data that deviate from the description.
fn wrong_models(study: &Study) -> Vec<Figure> {
    let mild = |o: &Outcome| o.plan.circumstances == Circumstances::ModelError;
    let single = |o: &Outcome| o.plan.wanted == Wanted::Any;
    let holes = |o: &Outcome| o.without_holes.is_some();
    let still_visible = |o: &Outcome| o.without_holes.is_some() && o.drawn.visible;
    let wrong = |o: &Outcome| !o.wrong_names.is_empty();
    let of = |what, target, pick: &dyn Fn(&Outcome) -> bool, count: &dyn Fn(&Outcome) -> bool| {
        figure(study, (what, Some(target)), pick, count)
    };
    let named = |o: &Outcome| o.found == [Found::Named];
    let arrives = |o: &Outcome| o.without_holes.as_ref().is_some_and(|w| w.fit_arrives);
    let as_without = |o: &Outcome| {
        let without = o.without_holes.as_ref().map(|w| &w.found);
        without.is_some_and(|without| found(o) || o.found <= *without)
    };
    let tails = |o: &Outcome| {
        use Circumstances::{HeavyTails, Standstills};
        matches!(o.plan.circumstances, HeavyTails | Standstills)
    };
    let mild_one = |o: &Outcome| mild(o) && single(o);
    let mild_any = |o: &Outcome| mild(o) && o.plan.wanted != Wanted::CommonOffset;
    vec![
        of(
            "model slightly wrong: the effect named",
            Target::AtLeast(0.85),
            &mild_one,
            &named,
        ),
        of(
            "model slightly wrong: a wrong name",
            Target::AtMost(0.03),
            &mild_any,
            &wrong,
        ),
        of(
            "empty cells: the fit arrives",
            Target::AtLeast(1.0),
            &holes,
            &arrives,
        ),
        of(
            "empty cells: found as without them",
            Target::AtLeast(1.0),
            &still_visible,
            &as_without,
        ),
        of(
            "heavy tails or shared errors: a wrong name",
            Target::AtMost(0.03),
            &tails,
            &wrong,
        ),
    ]
}

fn numbers(study: &Study) -> Vec<Figure> {
    let visible = |o: &Outcome| o.drawn.visible && o.held_out_ratio.is_some();
    let close = |o: &Outcome| o.held_out_ratio.is_some_and(|ratio| ratio <= HELD_OUT);
    let what = "held-out error within 5 % of that of the true model";
    let parameters = study.outcomes.iter().flat_map(|o| &o.parameters);
    let covered = parameters
        .clone()
        .filter(|error| error.standardised.abs() < NORMAL_95);
    vec![
        figure(study, (what, None), visible, close),
        Figure {
            what: "parameters of named effects: 95 % intervals that cover the truth",
            count: covered.count(),
            of: parameters.count(),
            target: Some(Target::Within(0.93, 0.97)),
        },
    ]
}

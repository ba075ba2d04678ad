//! The figures of a study beside what is asked for.

use std::fmt;

use super::{found, is_honest, is_outside, typical};
use crate::hidden::interval::{binomial_tail, clopper_pearson};
use crate::hidden::judge::Found;
use crate::hidden::{Outcome, Stratum, Study, Wanted};

/// Size of a 95 % interval in standard deviations.
pub(super) const NORMAL_95: f64 = 1.959_964;
/// Held-out error over that of the true model that is asked for.
const HELD_OUT: f64 = 1.05;

/// What is asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Target {
    /// At least this share.
    AtLeast(f64),
    /// At most this share.
    AtMost(f64),
    /// A share in between.
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

/// A count beside what is asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// What is counted.
    pub what: &'static str,
    /// How many.
    pub count: usize,
    /// Of how many.
    pub of: usize,
    /// What is asked for.
    pub target: Option<Target>,
}

impl Figure {
    /// Share.
    #[must_use]
    pub fn share(&self) -> f64 {
        self.count as f64 / self.of.max(1) as f64
    }

    /// 95 % interval of the share.
    #[must_use]
    pub fn interval(&self) -> [f64; 2] {
        clopper_pearson(self.count, self.of)
    }

    /// Probability of a count at least as bad if the share were just what is asked for.
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
    /// One after the other; those about nothing have `of` 0.
    pub all: Vec<Figure>,
}

/// Counts the outcomes that `pick` takes and `count` accepts.
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
    /// The figures of a study.
    #[must_use]
    pub fn of(study: &Study) -> Self {
        let mut all = singles(study);
        all.extend(others(study));
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

/// Named with confidence and wrong, the truth not named.
fn wrong(o: &Outcome) -> bool {
    !found(o) && !o.wrong_names.is_empty()
}

fn and_more(o: &Outcome) -> bool {
    found(o) && !o.wrong_names.is_empty()
}

fn singles(study: &Study) -> Vec<Figure> {
    let named = |o: &Outcome| o.found == [Found::Named];
    let silent = |o: &Outcome| o.answers.is_empty();
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
            &and_more,
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
    let clean = |o: &Outcome| o.plan.wanted == Wanted::Nothing;
    let two = |o: &Outcome| o.plan.wanted == Wanted::Two;
    let any = |o: &Outcome| !o.answers.is_empty();
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
            is_honest,
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

//! Figures of a study with their requirements.

use std::fmt;

use tautline_core::diagnosis::Verdict;

use super::{
    found, has_finding_without_wrong_name, is_found, is_noticed_without_wrong_name, is_outside,
    typical,
};
use crate::tables::counting::{Share, binomial_tail};
use crate::tables::hidden::judge::Found;
use crate::tables::hidden::{Circumstances, FindingRecord, Outcome, Stratum, Study, Wanted};
use crate::tables::simulated::NORMAL_95;

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
    pub what: String,
    /// The count.
    pub share: Share,
    /// Required share, if any.
    pub target: Option<Target>,
}

impl Figure {
    /// Probability of a count at least as bad if the true share just met the requirement.
    #[must_use]
    pub fn p_value(&self) -> f64 {
        let Share { part, whole } = self.share;
        let at_least = |p: f64| binomial_tail(whole, whole - part, 1.0 - p);
        let at_most = |p: f64| binomial_tail(whole, part, p);
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
    /// The figures in order; those without cases are of nothing.
    pub all: Vec<Figure>,
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

type Is = fn(&Outcome) -> bool;

fn least(share: f64) -> Option<Target> {
    Some(Target::AtLeast(share))
}

fn most(share: f64) -> Option<Target> {
    Some(Target::AtMost(share))
}

/// Figures of the data sets of one kind.
struct Kind<'s> {
    name: &'static str,
    outcomes: Vec<&'s Outcome>,
}

impl<'s> Kind<'s> {
    fn new(study: &'s Study, name: &'static str, is: Is) -> Self {
        let outcomes = study.outcomes.iter().filter(|outcome| is(outcome));
        Self {
            name,
            outcomes: outcomes.collect(),
        }
    }

    fn figure(&self, what: &str, target: Option<Target>, share: Share) -> Figure {
        Figure {
            what: format!("{}: {what}", self.name),
            share,
            target,
        }
    }

    /// Counts data sets.
    fn sets(&self, what: &str, target: Option<Target>, is: Is) -> Figure {
        self.figure(what, target, Share::of(self.outcomes.iter(), |o| is(o)))
    }

    /// Counts hidden effects.
    fn effects(&self, what: &str, target: Option<Target>, is: fn(&Found) -> bool) -> Figure {
        let found = self.outcomes.iter().flat_map(|outcome| &outcome.found);
        self.figure(what, target, Share::of(found, is))
    }
}

fn is_silent(o: &Outcome) -> bool {
    o.said.is_empty()
}

fn is_named(o: &Outcome) -> bool {
    o.found == [Found::Named]
}

fn has_wrong_name(o: &Outcome) -> bool {
    !o.wrong_names.is_empty()
}

/// Whether a wrong effect is named and a hidden one is not found.
fn is_other_named(o: &Outcome) -> bool {
    !found(o) && has_wrong_name(o)
}

fn is_first(o: &Outcome) -> bool {
    let right = |said: &FindingRecord| said.candidates.first().is_some_and(|c| c.right);
    let first = o.said.first();
    first.is_some_and(|said| said.verdict == Verdict::Named && right(said))
}

fn singles(study: &Study) -> Vec<Figure> {
    let typical = Kind::new(study, "typical size", typical);
    let just = Kind::new(study, "just visible", |o| {
        o.drawn.visible && matches!(o.plan.wanted, Wanted::One(_, Stratum::JustVisible))
    });
    let not = Kind::new(study, "not visible", |o| {
        !o.drawn.visible && matches!(o.plan.wanted, Wanted::One(..))
    });
    let listed = "named, or listed among at most three that fit as well";
    let other = "another named with confidence";
    vec![
        typical.sets(listed, least(0.97), found),
        typical.sets("named alone", None, is_named),
        typical.sets(other, most(0.005), is_other_named),
        typical.sets("right, and a wrong name besides", None, |o| {
            found(o) && has_wrong_name(o)
        }),
        just.sets("named or listed", None, found),
        just.sets(other, None, is_other_named),
        just.sets("nothing said", None, is_silent),
        not.sets("nothing said", None, is_silent),
        not.sets(other, None, is_other_named),
    ]
}

fn others(study: &Study) -> Vec<Figure> {
    let clean = Kind::new(study, "clean data", |o| {
        o.plan.wanted == Wanted::Nothing && o.plan.circumstances == Circumstances::AsStated
    });
    let outside = Kind::new(study, "outside the catalogue", is_outside);
    let two = Kind::new(study, "two effects", |o| o.plan.wanted == Wanted::Two);
    let noticed = "unknown, ambiguous or noisier than described";
    vec![
        clean.sets("any finding", most(0.01), |o| !is_silent(o)),
        outside.sets(
            "unknown or ambiguous",
            least(0.9),
            has_finding_without_wrong_name,
        ),
        outside.sets(noticed, least(0.9), is_noticed_without_wrong_name),
        outside.sets("named with confidence", most(0.03), has_wrong_name),
        two.sets("both named or listed", least(0.9), found),
        two.sets("another named with confidence", most(0.005), has_wrong_name),
    ]
}

/// Figures for several effects at once, families, exchanged channels and dominating effects.
fn several_effects(study: &Study) -> Vec<Figure> {
    let separated = Kind::new(study, "separated by exact evidence", |o| {
        o.plan.wanted == Wanted::Separated
    });
    let several = Kind::new(study, "three to five effects", |o| {
        o.plan.wanted == Wanted::Several
    });
    let offset = Kind::new(study, "dominating offset", |o| {
        o.plan.wanted == Wanted::CommonOffset && o.drawn.visible
    });
    let families = Kind::new(study, "families", |o| o.plan.wanted == Wanted::Families);
    let exchanged = Kind::new(study, "exchanged channels", |o| {
        matches!(o.plan.wanted, Wanted::Exchanged(_))
    });
    let named = |found: &Found| *found == Found::Named;
    let without_reason = Outcome::unknown_without_reason;
    vec![
        separated.sets("named alone", least(0.95), |o| {
            is_named(o) && o.said.len() == 1
        }),
        separated.sets("a wrong name", most(0.003), has_wrong_name),
        several.effects("named", least(0.9), named),
        several.effects("named or listed", least(0.98), is_found),
        several.sets("a wrong name", most(0.02), has_wrong_name),
        several.sets("`unknown` for no reason", most(0.02), without_reason),
        offset.sets("named first", least(0.95), is_first),
        families.effects("members named", least(0.9), named),
        exchanged.sets("named", least(1.0), is_named),
        exchanged.sets("within 2 s", least(1.0), |o| o.seconds < 2.0),
    ]
}

/// Figures for data that deviate from the description.
fn wrong_models(study: &Study) -> Vec<Figure> {
    let mild = "model slightly wrong";
    let single = Kind::new(study, mild, |o| {
        o.plan.circumstances == Circumstances::ModelError && o.plan.wanted == Wanted::Any
    });
    let any = Kind::new(study, mild, |o| {
        o.plan.circumstances == Circumstances::ModelError && o.plan.wanted != Wanted::CommonOffset
    });
    let holes = Kind::new(study, "empty cells", |o| o.without_holes.is_some());
    let visible = Kind::new(study, "empty cells", |o| {
        o.without_holes.is_some() && o.drawn.visible
    });
    let as_without = |o: &Outcome| {
        let without = o.without_holes.as_ref().map(|w| &w.found);
        without.is_some_and(|without| found(o) || o.found <= *without)
    };
    let tails = Kind::new(study, "heavy tails or shared errors", |o| {
        use Circumstances::{HeavyTails, Standstills};
        matches!(o.plan.circumstances, HeavyTails | Standstills)
    });
    vec![
        single.sets("the effect named", least(0.85), is_named),
        any.sets("a wrong name", most(0.03), has_wrong_name),
        holes.sets("the fit arrives", least(1.0), |o| {
            o.without_holes.as_ref().is_some_and(|w| w.fit_arrives)
        }),
        visible.sets("found as without them", least(1.0), as_without),
        tails.sets("a wrong name", most(0.03), has_wrong_name),
    ]
}

fn numbers(study: &Study) -> Vec<Figure> {
    let ratios = study.outcomes.iter().filter(|o| o.drawn.visible);
    let ratios = ratios.filter_map(|o| o.held_out_ratio);
    let parameters = study.outcomes.iter().flat_map(|o| &o.parameters);
    vec![
        Figure {
            what: "held-out error within 5 % of that of the true model".to_owned(),
            share: Share::of(ratios, |ratio| ratio <= HELD_OUT),
            target: None,
        },
        Figure {
            what: "parameters of named effects: 95 % intervals that cover the truth".to_owned(),
            share: Share::of(parameters, |error| error.standardised.abs() < NORMAL_95),
            target: Some(Target::Within(0.93, 0.97)),
        },
    ]
}

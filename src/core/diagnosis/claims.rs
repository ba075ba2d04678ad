//! What the posterior of the sets says of each cause: its probability, and what else could stand in its place.

use super::candidates::is_alike;
use super::inference::Ranked;
use super::report::{Alternative, Cause};
use crate::effect::{Scope, Search};

/// Probability from which a cause is named, or several together are listed.
pub(super) const SURE: f64 = 0.95;
/// Most causes that are listed beside one.
const MOST_ALTERNATIVES: usize = 2;
/// Probability from which an alternative is worth a line.
const WORTH_A_LINE: f64 = 0.005;
/// Probability from which something is possible.
const POSSIBLE: f64 = 0.05;

/// What is known of one cause of the likeliest set.
#[derive(Debug, Clone)]
pub(super) struct Claim {
    pub probability: f64,
    /// What stands in its place in the other sets, the likeliest first.
    pub alternatives: Vec<Alternative>,
    /// Whether it or one of its alternatives is there with near certainty.
    pub is_sure: bool,
}

impl Claim {
    pub fn is_named(&self) -> bool {
        self.probability >= SURE
    }
}

/// The claims of the causes of the likeliest set, which is the first of the ranking, and what else is possible.
pub(super) fn claims(ranking: &[Ranked]) -> (Vec<Claim>, Vec<Alternative>) {
    let Some(first) = ranking.first() else {
        return (Vec::new(), Vec::new());
    };
    let top = ranking
        .iter()
        .map(|r| r.log_posterior)
        .fold(f64::NEG_INFINITY, f64::max);
    let weight = |r: &Ranked| (r.log_posterior - top).exp();
    let total: f64 = ranking.iter().map(weight).sum();
    let mut probability = vec![0.0; first.causes.len()];
    let mut others: Vec<Vec<Alternative>> = vec![Vec::new(); first.causes.len()];
    let mut beside: Vec<Alternative> = Vec::new();
    for set in ranking {
        let share = weight(set) / total;
        let supports = |cause: &Cause, of: &Cause| is_support(cause, of);
        let mut spare: Vec<&Cause> = Vec::new();
        for cause in &set.causes {
            if !first.causes.iter().any(|own| supports(cause, own)) {
                spare.push(cause);
            }
        }
        for cause in &spare {
            add(&mut beside, cause, share);
        }
        for (place, own) in first.causes.iter().enumerate() {
            if set.causes.iter().any(|cause| supports(cause, own)) {
                probability[place] += share;
                continue;
            }
            // What is on the same cable stands in its place first.
            let overlap = |cause: &&Cause| {
                let cables = own.cables();
                cause.cables().iter().any(|c| cables.contains(c))
            };
            let instead = spare
                .iter()
                .position(overlap)
                .or((!spare.is_empty()).then_some(0));
            if let Some(instead) = instead {
                add(&mut others[place], spare.remove(instead), share);
            }
        }
    }
    let claim = |((probability, mut alternatives), own): ((f64, Vec<Alternative>), &Cause)| {
        alternatives.sort_by(|a, b| b.probability.total_cmp(&a.probability));
        let all: f64 = alternatives.iter().map(|a| a.probability).sum();
        let mut sum = probability;
        let mut kept: Vec<Alternative> = Vec::new();
        for alternative in alternatives {
            // The same at another pose is no other cause.
            let listed = kept.iter().map(|k| &k.cause);
            if std::iter::once(own)
                .chain(listed)
                .any(|c| is_alike(c, &alternative.cause))
            {
                sum += alternative.probability;
                continue;
            }
            if sum >= SURE
                || kept.len() == MOST_ALTERNATIVES
                || alternative.probability < WORTH_A_LINE
            {
                break;
            }
            sum += alternative.probability;
            kept.push(alternative);
        }
        Claim {
            probability,
            alternatives: kept,
            is_sure: probability + all >= SURE,
        }
    };
    let known = probability.into_iter().zip(others);
    let claims: Vec<Claim> = known.zip(&first.causes).map(claim).collect();
    let listed = |cause: &Cause| {
        claims
            .iter()
            .any(|c| c.alternatives.iter().any(|a| is_support(&a.cause, cause)))
    };
    beside.retain(|a| a.probability >= POSSIBLE && !listed(&a.cause));
    beside.sort_by(|a, b| b.probability.total_cmp(&a.probability));
    (claims, beside)
}

fn add(all: &mut Vec<Alternative>, cause: &Cause, probability: f64) {
    match all.iter_mut().find(|known| is_support(&known.cause, cause)) {
        Some(known) => known.probability += probability,
        None => all.push(Alternative {
            cause: cause.clone(),
            probability,
        }),
    }
}

/// Whether a cause says the same as another, but for its values: on the same cables, or with a value for each of more
/// cables or fewer; an event at the same reading, a step at a pose beside it.
fn is_support(one: &Cause, other: &Cause) -> bool {
    if !std::ptr::eq(one.effect(), other.effect()) {
        return false;
    }
    let place = |cause: &Cause, k: usize| cause.instances[0].values[k];
    let near = match one.effect().search() {
        Search::AtPose(k) => place(one, k) == place(other, k),
        Search::FromPose(k) => (place(one, k) - place(other, k)).abs() <= 1.0,
        _ => true,
    };
    let (a, b) = (one.cables(), other.cables());
    let contains = |all: &Cause, cables: &[usize], some: &[usize]| {
        let several = all.instances.len() > 1 || cables.len() > 1;
        several && !some.is_empty() && some.iter().all(|c| cables.contains(c))
    };
    let whole = |one: &Cause, other: &Cause| {
        one.cables().is_empty() && other.instances.len() == one.instances[0].cables.len()
    };
    let all = one.effect().scope() == Scope::CableOrAll && (whole(one, other) || whole(other, one));
    near && (a == b || all || contains(one, &a, &b) || contains(other, &b, &a))
}

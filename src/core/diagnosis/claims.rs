//! Posterior probabilities of the causes of the most probable set, and of what replaces them in other sets.

use super::candidates::{is_alike, is_same_kind};
use super::inference::Ranked;
use super::report::{Alternative, Cause};
use crate::effect::Search;

/// Posterior probability from which a cause is named, or several together are listed.
pub(super) const SURE: f64 = 0.95;
/// Upper bound of the share of names that are imitations by errors outside the catalogue.
pub(super) const MOST_IMITATED: f64 = 0.03;
/// Maximum number of alternatives listed with a cause.
const MOST_ALTERNATIVES: usize = 2;
/// Smallest probability of an alternative that is listed.
const WORTH_A_LINE: f64 = 0.005;
/// Smallest probability of a possible cause.
const POSSIBLE: f64 = 0.05;
/// Odds against a cause that the evidence makes possible but that did not become a finding: where the findings explain
/// the readings, and where an unmodelled error remains, which explains what such a cause would explain. Of 103 and 93
/// such causes in simulated data, half of them with effects outside the catalogue or a slightly wrong model, 4 and 0
/// were present.
const UNCONFIRMED: f64 = 5.0;
const SUPERSEDED: f64 = 20.0;

/// Posterior of one cause of the most probable set.
#[derive(Debug, Clone)]
pub(super) struct Claim {
    pub probability: f64,
    /// What replaces it in the other sets, most probable first.
    pub alternatives: Vec<Alternative>,
    /// Whether it or one of its alternatives is present with near certainty.
    pub is_sure: bool,
}

impl Claim {
    pub fn is_named(&self) -> bool {
        self.probability >= SURE
    }
}

/// Lowers the probabilities of possible causes that did not become findings, and drops those that are then too small.
pub(super) fn possible_after(possible: Vec<Alternative>, has_nameless: bool) -> Vec<Alternative> {
    let against = if has_nameless {
        SUPERSEDED
    } else {
        UNCONFIRMED
    };
    let discounted = |other: Alternative| {
        let stated = other.probability.min(SURE);
        Alternative {
            probability: stated / (stated + (1.0 - stated) * against),
            ..other
        }
    };
    let all = possible.into_iter().map(discounted);
    all.filter(|other| other.probability >= POSSIBLE).collect()
}

/// Posteriors of the causes of the most probable set, which is the first of the ranking, and the other possible causes.
pub(super) fn claims(ranking: &[Ranked]) -> (Vec<Claim>, Vec<Alternative>) {
    let Some(first) = ranking.first() else {
        return (Vec::new(), Vec::new());
    };
    let top = ranking
        .iter()
        .map(|r| r.log_posterior)
        .fold(f64::NEG_INFINITY, f64::max);
    if !top.is_finite() {
        // No set of causes makes these readings possible.
        return (Vec::new(), Vec::new());
    }
    let weight = |r: &Ranked| (r.log_posterior - top).exp();
    let total: f64 = ranking.iter().map(weight).sum();
    let mut probability = vec![0.0; first.causes.len()];
    let mut others: Vec<Vec<Alternative>> = vec![Vec::new(); first.causes.len()];
    let mut beside: Vec<Alternative> = Vec::new();
    for set in ranking {
        let share = weight(set) / total;
        let is_spare = |cause: &&Cause| first.causes.iter().all(|own| !is_support(cause, own));
        let mut spare: Vec<&Cause> = set.causes.iter().filter(is_spare).collect();
        for cause in &spare {
            add(&mut beside, cause, share);
        }
        let mut missing: Vec<usize> = Vec::new();
        for (place, own) in first.causes.iter().enumerate() {
            if is_said_by(&set.causes, own) {
                probability[place] += share;
            } else {
                missing.push(place);
            }
        }
        // Several cables of a family may have values of their own while the others have none.
        missing.retain(|place| {
            let (mut some, left): (Vec<&Cause>, Vec<&Cause>) = spare
                .iter()
                .partition(|cause| is_part(cause, &first.causes[*place]));
            if some.len() < 2 {
                return true;
            }
            spare = left;
            some.sort_by_key(|cause| cause.cables());
            let instances = some.iter().flat_map(|cause| cause.instances.clone());
            let together = Cause {
                instances: instances.collect(),
            };
            add(&mut others[*place], &together, share);
            false
        });
        // A cause on the same cable is the first choice for a replacement.
        missing.retain(|place| {
            let cables = first.causes[*place].cables();
            let overlaps = |cause: &&Cause| cause.cables().iter().any(|c| cables.contains(c));
            let instead = spare.iter().position(overlaps);
            if let Some(instead) = instead {
                add(&mut others[*place], spare.remove(instead), share);
            }
            instead.is_none()
        });
        // A family that covers another cause of the set may also replace this one.
        let is_wider = |cause: &&Cause| {
            let mut supported = first
                .causes
                .iter()
                .filter(|of| is_support(cause, of))
                .peekable();
            supported.peek().is_some() && supported.all(|of| !is_alike(cause, of))
        };
        let wider = set.causes.iter().find(is_wider);
        for place in missing {
            let instead = (!spare.is_empty()).then(|| spare.remove(0)).or(wider);
            if let Some(instead) = instead {
                add(&mut others[place], instead, share);
            }
        }
    }
    let claim = |((probability, mut alternatives), own): ((f64, Vec<Alternative>), &Cause)| {
        alternatives.sort_by(|a, b| b.probability.total_cmp(&a.probability));
        let all: f64 = alternatives.iter().map(|a| a.probability).sum();
        let mut sum = probability;
        let mut kept: Vec<Alternative> = Vec::new();
        for alternative in alternatives {
            // The same event at another pose is not another cause.
            let listed = kept.iter().map(|k| &k.cause);
            if std::iter::once(own)
                .chain(listed)
                .any(|c| is_alike(c, &alternative.cause))
            {
                sum += alternative.probability;
                continue;
            }
            if sum * (1.0 - MOST_IMITATED) >= SURE
                || kept.len() == MOST_ALTERNATIVES
                || alternative.probability < WORTH_A_LINE
            {
                break;
            }
            sum += alternative.probability;
            kept.push(alternative);
        }
        Claim {
            // Rounding can make the sum of weights exceed 1.
            probability: probability.min(1.0),
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

/// Whether a set accounts for a cause, either by one of its causes or by several of the same effect on single cables.
fn is_said_by(set: &[Cause], own: &Cause) -> bool {
    let is_same = |cause: &&Cause| {
        std::ptr::eq(cause.effect(), own.effect()) && own.effect().pose_parameter().is_none()
    };
    let together: Vec<usize> = set.iter().filter(is_same).flat_map(Cause::cables).collect();
    let cables = own.cables();
    // A common value plus a deviation of one cable is not the same as a value for each cable.
    let is_more = |cause: &Cause| is_part(cause, own) && !is_support(cause, own);
    let has_more = set.iter().any(is_more);
    let is_each = |cause: &Cause| !has_more || std::ptr::eq(cause.effect(), own.effect());
    set.iter()
        .any(|cause| is_support(cause, own) && is_each(cause))
        || cables.len() > 1 && cables.iter().all(|cable| together.contains(cable))
}

/// Whether a cause is the effect of a family on just one of its cables.
fn is_part(cause: &Cause, family: &Cause) -> bool {
    let all = family.cables();
    family.instances.len() > 1
        && std::ptr::eq(cause.effect(), family.effect())
        && cause.effect().pose_parameter().is_none()
        && cause.cables().len() == 1
        && cause.cables().iter().all(|cable| all.contains(cable))
}

/// Whether one cause covers another, apart from parameter values: on the same cables or more, with an event at the same
/// reading or a step at most one pose away.
fn is_support(one: &Cause, other: &Cause) -> bool {
    let whole = |one: &Cause, other: &Cause| {
        one.cables().is_empty() && other.instances.len() == one.instances[0].cables.len()
    };
    // A value for all cables covers a value for each, and vice versa.
    if is_same_kind(one.effect(), other.effect()) && (whole(one, other) || whole(other, one)) {
        return true;
    }
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
    let more = a.len() > 1 && !b.is_empty() && b.iter().all(|cable| a.contains(cable));
    near && (a == b || more)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::{BoundEffect, find};

    fn bound(id: &str, cables: &[usize], targeted: bool) -> BoundEffect {
        let effect = find(id).unwrap();
        BoundEffect {
            effect,
            cables: cables.to_vec(),
            targeted,
            values: effect.parameters().iter().map(|p| p.start).collect(),
        }
    }

    fn on(id: &str, cables: &[usize]) -> Cause {
        Cause {
            instances: vec![bound(id, cables, true)],
        }
    }

    fn each(id: &str, cables: usize) -> Cause {
        Cause {
            instances: (0..cables).map(|cable| bound(id, &[cable], true)).collect(),
        }
    }

    fn ranked(sets: Vec<(Vec<Cause>, f64)>) -> Vec<Ranked> {
        let ranked = |(causes, probability): (Vec<Cause>, f64)| Ranked {
            causes,
            log_posterior: probability.ln(),
        };
        sets.into_iter().map(ranked).collect()
    }

    #[test]
    fn some_cables_are_named_only_where_all_of_them_are_meant() {
        let shared = on("cable_sag", &[1, 4, 5]);
        let pair = vec![on("cable_sag", &[1]), on("cable_sag", &[4])];
        let all = vec![
            on("cable_sag", &[1]),
            on("cable_sag", &[4]),
            on("cable_sag", &[5]),
        ];
        let (claims, _) = claims(&ranked(vec![(vec![shared], 0.5), (pair, 0.3), (all, 0.2)]));
        // The pair does not cover the third cable, so it replaces the common cause.
        assert!((claims[0].probability - 0.7).abs() < 1e-12, "{claims:?}");
        assert!((claims[0].alternatives[0].probability - 0.3).abs() < 1e-12);
        assert!(!claims[0].is_named() && claims[0].is_sure);
    }

    #[test]
    fn nothing_is_claimed_of_readings_that_no_set_makes_possible() {
        let impossible = Ranked {
            causes: vec![on("payload_mass", &[])],
            log_posterior: f64::NEG_INFINITY,
        };
        let (claims, beside) = claims(&[impossible]);
        assert!(claims.is_empty() && beside.is_empty());
    }

    #[test]
    fn a_family_stands_for_two_causes_at_once() {
        let first = vec![on("payload_mass", &[]), on("force_gain", &[3])];
        let family = vec![each("force_gain", 4)];
        let (claims, beside) = claims(&ranked(vec![(first, 0.6), (family, 0.4)]));
        assert!((claims[0].probability - 0.6).abs() < 1e-12);
        let alternative = &claims[0].alternatives[0];
        assert_eq!(alternative.cause.cables(), [0, 1, 2, 3]);
        assert!(claims[0].is_sure && claims[1].is_named(), "{claims:?}");
        assert!(beside.is_empty());
    }

    #[test]
    fn some_cables_of_a_family_stand_in_its_place_together() {
        let family = vec![on("payload_mass", &[]), each("force_gain", 4)];
        let pair = vec![
            on("force_gain", &[3]),
            on("payload_mass", &[]),
            on("force_gain", &[1]),
        ];
        let (claims, beside) = claims(&ranked(vec![(family, 0.6), (pair, 0.4)]));
        let [alternative] = claims[1].alternatives.as_slice() else {
            panic!("{claims:?}");
        };
        assert_eq!(alternative.cause.cables(), [1, 3]);
        assert!((alternative.probability - 0.4).abs() < 1e-12);
        assert!(claims[0].is_named() && !claims[1].is_named() && beside.is_empty());
    }

    #[test]
    fn what_is_on_the_same_cable_stands_in_its_place_first() {
        let first = vec![on("payload_mass", &[]), on("cable_slip", &[1])];
        let other = vec![on("frame_shift", &[1]), on("laser_bias", &[])];
        let (claims, _) = claims(&ranked(vec![(first, 0.6), (other, 0.4)]));
        let instead = |k: usize| claims[k].alternatives[0].cause.effect().id();
        assert_eq!((instead(0), instead(1)), ("laser_bias", "frame_shift"));
    }
}

//! Posterior probabilities of the causes of the most probable set, and of their replacements in other sets.

use super::budget::{MAX_ALTERNATIVES, MIN_LISTED_PROBABILITY, MIN_POSSIBLE_PROBABILITY};
use super::calibration::{NAMING_PROBABILITY, stated_probability};
use super::cause_sets::RankedSet;
use super::relations::{covers, is_covered_by, is_family_member, is_same_effect_and_targets};
use super::report::{Cause, PossibleCause};
use crate::effect::Search;

/// Posterior of one cause of the most probable set.
#[derive(Debug, Clone)]
pub(super) struct CausePosterior {
    pub probability: f64,
    /// Replacements of the cause in the other sets, most probable first.
    pub alternatives: Vec<PossibleCause>,
    /// Probability of the cause and of all its replacements in the other sets, listed or not.
    pub with_replacements: f64,
}

impl CausePosterior {
    /// Whether the cause or one of its replacements is present with near certainty.
    pub fn is_near_certain(&self) -> bool {
        self.with_replacements >= NAMING_PROBABILITY
    }

    /// The cause and its alternatives as possible causes.
    pub fn as_possible(&self, cause: &Cause) -> impl Iterator<Item = PossibleCause> {
        let named = PossibleCause {
            cause: cause.clone(),
            probability: self.probability,
        };
        std::iter::once(named).chain(self.alternatives.iter().cloned())
    }

    pub fn is_named(&self) -> bool {
        self.probability * stated_share(self.with_replacements) >= NAMING_PROBABILITY
    }
}

/// Ratio of the stated to the computed probability that one of several causes that exclude each other is present.
pub(super) fn stated_share(computed: f64) -> f64 {
    stated_probability(computed.min(1.0)) / computed.max(f64::MIN_POSITIVE)
}

/// States the probabilities of possible causes that did not become findings, the most probable first, without those that are
/// too small.
pub(super) fn stated_causes(mut possible: Vec<PossibleCause>) -> Vec<PossibleCause> {
    possible.sort_by(|a, b| b.probability.total_cmp(&a.probability));
    let stated = |other: PossibleCause| PossibleCause {
        probability: stated_probability(other.probability.min(1.0)),
        ..other
    };
    let list = possible.into_iter().map(stated);
    list.filter(|other| other.probability >= MIN_POSSIBLE_PROBABILITY)
        .collect()
}

/// Posteriors of the causes of the most probable set, which is the first of the ranking, and the other possible causes.
pub(super) fn cause_posteriors(ranking: &[RankedSet]) -> (Vec<CausePosterior>, Vec<PossibleCause>) {
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
    let weight = |r: &RankedSet| (r.log_posterior - top).exp();
    let total: f64 = ranking.iter().map(weight).sum();
    let mut probability = vec![0.0; first.causes.len()];
    let mut others: Vec<Vec<PossibleCause>> = vec![Vec::new(); first.causes.len()];
    let mut beside: Vec<PossibleCause> = Vec::new();
    for set in ranking {
        let share = weight(set) / total;
        let causes = with_matching_waves(&set.causes, &first.causes);
        let is_spare = |cause: &&Cause| first.causes.iter().all(|present| !covers(cause, present));
        let mut spare: Vec<&Cause> = causes.iter().filter(is_spare).collect();
        // Several causes of a set, such as cables of a family, may be one among the others.
        let mut counted = Vec::new();
        for cause in &spare {
            let index = place_of(&mut beside, cause);
            if !counted.contains(&index) {
                beside[index].probability += share;
                counted.push(index);
            }
        }
        let mut missing: Vec<usize> = Vec::new();
        for (index, cause) in first.causes.iter().enumerate() {
            if is_covered_by(&causes, cause) {
                probability[index] += share;
            } else {
                missing.push(index);
            }
        }
        // Several cables of a family may have values of their own while the others have none.
        missing.retain(|index| {
            let (mut some, rest): (Vec<&Cause>, Vec<&Cause>) = spare
                .iter()
                .partition(|cause| is_family_member(cause, &first.causes[*index]));
            if some.len() < 2 {
                return true;
            }
            spare = rest;
            some.sort_by_key(|cause| cause.cables());
            let instances = some.iter().flat_map(|cause| cause.instances.clone());
            let together = Cause {
                instances: instances.collect(),
            };
            add_probability(&mut others[*index], &together, share);
            false
        });
        // A cause on the same cable is the first choice for a replacement.
        missing.retain(|index| {
            let cables = first.causes[*index].cables();
            let overlaps = |cause: &&Cause| cause.cables().iter().any(|c| cables.contains(c));
            let instead = spare.iter().position(overlaps);
            if let Some(instead) = instead {
                add_probability(&mut others[*index], spare.remove(instead), share);
            }
            instead.is_none()
        });
        // A family that covers another cause of the set may also replace this one.
        let is_wider = |cause: &&Cause| {
            let mut supported = first.causes.iter().filter(|c| covers(cause, c)).peekable();
            supported.peek().is_some() && supported.all(|c| !is_same_effect_and_targets(cause, c))
        };
        let wider = causes.iter().find(is_wider);
        for index in missing {
            let instead = (!spare.is_empty()).then(|| spare.remove(0)).or(wider);
            if let Some(instead) = instead {
                add_probability(&mut others[index], instead, share);
            }
        }
    }
    let posterior =
        |((probability, mut alternatives), cause): ((f64, Vec<PossibleCause>), &Cause)| {
            alternatives.sort_by(|a, b| b.probability.total_cmp(&a.probability));
            let replacements: f64 = alternatives.iter().map(|a| a.probability).sum();
            // Rounding can make the sum of weights exceed 1.
            let with_replacements = (probability + replacements).min(1.0);
            let needed = NAMING_PROBABILITY / stated_share(with_replacements);
            let mut sum = probability;
            let mut kept: Vec<PossibleCause> = Vec::new();
            for alternative in alternatives {
                // The same event at another pose is not another cause.
                let listed = kept.iter().map(|k| &k.cause);
                if std::iter::once(cause)
                    .chain(listed)
                    .any(|c| is_same_effect_and_targets(c, &alternative.cause))
                {
                    sum += alternative.probability;
                    continue;
                }
                if sum >= needed
                    || kept.len() == MAX_ALTERNATIVES
                    || alternative.probability < MIN_LISTED_PROBABILITY
                {
                    break;
                }
                sum += alternative.probability;
                kept.push(alternative);
            }
            CausePosterior {
                probability: probability.min(1.0),
                alternatives: kept,
                with_replacements,
            }
        };
    let weighted = probability.into_iter().zip(others);
    let posteriors: Vec<CausePosterior> = weighted.zip(&first.causes).map(posterior).collect();
    let listed = |cause: &Cause| {
        posteriors
            .iter()
            .any(|c| c.alternatives.iter().any(|a| covers(&a.cause, cause)))
    };
    beside.retain(|a| a.probability >= MIN_POSSIBLE_PROBABILITY && !listed(&a.cause));
    beside.sort_by(|a, b| b.probability.total_cmp(&a.probability));
    (posteriors, beside)
}

/// A set with its waves matched to those of another set: a wave that the other has at another period only takes that
/// period. Readings at few poses often leave several periods possible, but it is the same wave.
fn with_matching_waves(set: &[Cause], other: &[Cause]) -> Vec<Cause> {
    let is_wave = |cause: &&Cause| {
        matches!(
            cause.effect().search(),
            Search::Wave {
                period: Some(_),
                ..
            }
        )
    };
    let has = |causes: &[Cause], cause: &Cause| causes.iter().any(|c| covers(c, cause));
    let mut unmatched = other.iter().filter(is_wave).filter(|c| !has(set, c));
    let matched = |cause: &Cause| {
        let is_unmatched = is_wave(&cause) && !has(other, cause);
        let instead = is_unmatched.then(|| unmatched.next()).flatten();
        instead.unwrap_or(cause).clone()
    };
    set.iter().map(matched).collect()
}

fn add_probability(causes: &mut Vec<PossibleCause>, cause: &Cause, probability: f64) {
    let index = place_of(causes, cause);
    causes[index].probability += probability;
}

/// Index of a cause in a list, to which it is added unless a cause of the list covers it.
fn place_of(causes: &mut Vec<PossibleCause>, cause: &Cause) -> usize {
    let index = causes.iter().position(|other| covers(&other.cause, cause));
    index.unwrap_or_else(|| {
        causes.push(PossibleCause {
            cause: cause.clone(),
            probability: 0.0,
        });
        causes.len() - 1
    })
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

    fn ranked(sets: Vec<(Vec<Cause>, f64)>) -> Vec<RankedSet> {
        let ranked = |(causes, probability): (Vec<Cause>, f64)| RankedSet {
            causes,
            log_posterior: probability.ln(),
        };
        sets.into_iter().map(ranked).collect()
    }

    #[test]
    fn a_common_value_is_named_only_if_every_cable_has_it() {
        let shared = on("cable_sag", &[1, 4, 5]);
        let pair = vec![on("cable_sag", &[1]), on("cable_sag", &[4])];
        let all = vec![
            on("cable_sag", &[1]),
            on("cable_sag", &[4]),
            on("cable_sag", &[5]),
        ];
        let (posteriors, _) =
            cause_posteriors(&ranked(vec![(vec![shared], 0.5), (pair, 0.3), (all, 0.2)]));
        // The pair does not cover the third cable, so it replaces the common cause.
        assert!(
            (posteriors[0].probability - 0.7).abs() < 1e-12,
            "{posteriors:?}"
        );
        assert!((posteriors[0].alternatives[0].probability - 0.3).abs() < 1e-12);
        assert!(!posteriors[0].is_named() && posteriors[0].is_near_certain());
    }

    #[test]
    fn what_replaces_a_cause_counts_for_its_name() {
        let slip_or_shift = |slip: f64| {
            let sets = vec![
                (vec![on("winch_offset", &[5])], slip),
                (vec![on("platform_anchor", &[5])], 1.0 - slip),
            ];
            cause_posteriors(&ranked(sets)).0.remove(0)
        };
        // One of the two is certain, so that the name is stated with nearly its own probability.
        let named = slip_or_shift(0.97);
        assert!(named.is_named() && named.alternatives.is_empty());
        let listed = slip_or_shift(0.9);
        assert!(!listed.is_named() && listed.is_near_certain());
        assert_eq!(listed.alternatives.len(), 1);
        // If neither is certain, the same probability is no name.
        let none = vec![(vec![on("winch_offset", &[5])], 0.97), (Vec::new(), 0.03)];
        assert!(!cause_posteriors(&ranked(none)).0[0].is_named());
    }

    #[test]
    fn a_set_with_several_cables_of_a_family_counts_once() {
        let payload = || on("payload_mass", &[]);
        let singles = [1, 2, 3].map(|cable| on("force_gain", &[cable]));
        let sets = vec![
            (vec![payload()], 0.2),
            (vec![payload(), each("force_gain", 4)], 0.2),
            ([vec![payload()], singles.to_vec()].concat(), 0.6),
        ];
        let (_, beside) = cause_posteriors(&ranked(sets));
        assert_eq!(beside.len(), 1, "{beside:?}");
        assert!((beside[0].probability - 0.8).abs() < 1e-12, "{beside:?}");
    }

    #[test]
    fn impossible_readings_have_no_posteriors() {
        let impossible = RankedSet {
            causes: vec![on("payload_mass", &[])],
            log_posterior: f64::NEG_INFINITY,
        };
        let (posteriors, beside) = cause_posteriors(&[impossible]);
        assert!(posteriors.is_empty() && beside.is_empty());
    }

    #[test]
    fn a_wave_with_another_period_is_no_other_cause() {
        let wave = |period: f64| {
            let mut cause = on("laser_cyclic", &[]);
            cause.instances[0].values[1] = period;
            cause
        };
        let sets = vec![
            (vec![wave(0.2), wave(0.05)], 0.5),
            (vec![wave(0.3), wave(0.05)], 0.3),
            (vec![wave(0.2)], 0.2),
        ];
        let (posteriors, beside) = cause_posteriors(&ranked(sets));
        assert!((posteriors[0].probability - 1.0).abs() < 1e-12);
        assert!((posteriors[1].probability - 0.8).abs() < 1e-12);
        assert!(beside.is_empty(), "{beside:?}");
    }

    #[test]
    fn a_family_replaces_two_causes_at_once() {
        let first = vec![on("payload_mass", &[]), on("force_gain", &[3])];
        let family = vec![each("force_gain", 4)];
        let (posteriors, beside) = cause_posteriors(&ranked(vec![(first, 0.6), (family, 0.4)]));
        assert!((posteriors[0].probability - 0.6).abs() < 1e-12);
        let alternative = &posteriors[0].alternatives[0];
        assert_eq!(alternative.cause.cables(), [0, 1, 2, 3]);
        assert!(
            posteriors[0].is_near_certain() && posteriors[1].is_named(),
            "{posteriors:?}"
        );
        assert!(beside.is_empty());
    }

    #[test]
    fn single_cables_replace_their_family_together() {
        let family = vec![on("payload_mass", &[]), each("force_gain", 4)];
        let pair = vec![
            on("force_gain", &[3]),
            on("payload_mass", &[]),
            on("force_gain", &[1]),
        ];
        let (posteriors, beside) = cause_posteriors(&ranked(vec![(family, 0.6), (pair, 0.4)]));
        let [alternative] = posteriors[1].alternatives.as_slice() else {
            panic!("{posteriors:?}");
        };
        assert_eq!(alternative.cause.cables(), [1, 3]);
        assert!((alternative.probability - 0.4).abs() < 1e-12);
        assert!(posteriors[0].is_named() && !posteriors[1].is_named() && beside.is_empty());
    }

    #[test]
    fn causes_on_the_same_cable_are_replaced_first() {
        let first = vec![on("payload_mass", &[]), on("cable_slip", &[1])];
        let other = vec![on("frame_shift", &[1]), on("laser_bias", &[])];
        let (posteriors, _) = cause_posteriors(&ranked(vec![(first, 0.6), (other, 0.4)]));
        let instead = |k: usize| posteriors[k].alternatives[0].cause.effect().id();
        assert_eq!((instead(0), instead(1)), ("laser_bias", "frame_shift"));
    }
}

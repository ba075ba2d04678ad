//! Search over sets of causes at given hyperparameters.
//!
//! The best set that was not yet extended is extended by every candidate, and so is each set that results from dropping
//! one of its causes. The search thus adds, drops and exchanges causes until no set near the best is left. As no single
//! addition leads to several families of errors at once, a second start has all families and drops those that are not
//! needed. The evidence for dropping a cause is the ratio of the posterior and prior densities of its parameters at
//! zero (Savage and Dickey).

use std::collections::{HashMap, HashSet};

use super::budget::{EXTEND_WITHIN, MAX_RECORDED, MAX_REDUCED, MAX_REPLACEMENTS, RECORD_WITHIN};
use super::calibration::{COLLINEAR, LINEARISATION_ERROR};
use super::candidates::PoseWeights;
use super::evidence::{Member, System};
use super::gram::Gram;

/// Indices of candidates in ascending order.
pub(super) type CandidateSet = Vec<usize>;

/// A set that was evaluated.
#[derive(Debug, Clone)]
pub(super) struct EvaluatedSet {
    /// Members, with the scales that were best when each was added.
    pub members: Vec<Member>,
    /// Log evidence and prior.
    pub log_posterior: f64,
    /// Part of `log_posterior` that comes from summing over the scales of the members; `None` if the set was not settled.
    pub over_scales: Option<f64>,
}

/// The sets evaluated at given hyperparameters.
pub(super) struct Search<'g, 'l> {
    gram: &'g mut Gram<'l>,
    pub evaluated: HashMap<CandidateSet, EvaluatedSet>,
    extended: HashSet<CandidateSet>,
    /// Most causes of a set.
    most: usize,
}

/// Evaluates a set exactly: the scale of each member is optimised again, and the evidence is summed over the scales of
/// each member with the others at their best scale.
pub(super) fn settled(gram: &mut Gram<'_>, members: &[Member]) -> EvaluatedSet {
    let mut system = System::new(gram, members);
    let mut over_scales = 0.0;
    for place in 0..members.len() {
        let Some((scale, over_own)) = system.best_scale_of(gram, place) else {
            continue;
        };
        over_scales += over_own;
        if scale != system.members[place].1 {
            let mut members = system.members;
            members[place].1 = scale;
            system = System::new(gram, &members);
        }
    }
    EvaluatedSet {
        log_posterior: system.log_posterior + over_scales,
        over_scales: Some(over_scales),
        members: system.members,
    }
}

/// The subsets that lack one member each.
fn leave_one_out(members: &[Member]) -> impl Iterator<Item = Vec<Member>> {
    (0..members.len()).map(|left_out| {
        let mut fewer = members.to_vec();
        fewer.remove(left_out);
        fewer
    })
}

pub(super) fn set_of(members: &[Member]) -> CandidateSet {
    let mut set: CandidateSet = members.iter().map(|m| m.0).collect();
    set.sort_unstable();
    set
}

/// Members that are almost collinear with the others, such as a heavier platform, stiffer cables and force sensors that
/// read low. For these, the linear comparison mistakes the effect of noise on the derivatives for evidence.
pub(super) fn collinear_members(gram: &mut Gram<'_>, members: &[Member]) -> Vec<usize> {
    let each = members.iter().zip(leave_one_out(members));
    each.filter_map(|((index, _), others)| {
        let remaining = System::extensible_by(gram, &others, *index..=*index)
            .remaining_information(gram, *index);
        (remaining < COLLINEAR).then_some(*index)
    })
    .collect()
}

impl<'g, 'l> Search<'g, 'l> {
    pub fn new(gram: &'g mut Gram<'l>, most: usize) -> Self {
        Self {
            gram,
            evaluated: HashMap::new(),
            extended: HashSet::new(),
            most,
        }
    }

    /// Evaluates a set with the given scales and records it.
    pub fn evaluate(&mut self, members: &[Member]) -> f64 {
        let system = System::new(self.gram, members);
        self.record(members.to_vec(), system.log_posterior);
        system.log_posterior
    }

    fn record(&mut self, members: Vec<Member>, log_posterior: f64) {
        let entry = self.evaluated.entry(set_of(&members));
        let entry = entry.or_insert_with(|| EvaluatedSet {
            members: members.clone(),
            log_posterior: f64::NEG_INFINITY,
            over_scales: None,
        });
        if log_posterior > entry.log_posterior {
            *entry = EvaluatedSet {
                members,
                log_posterior,
                over_scales: None,
            };
        }
    }

    /// The best set.
    pub fn best(&self) -> Option<&EvaluatedSet> {
        let order =
            |a: &&EvaluatedSet, b: &&EvaluatedSet| a.log_posterior.total_cmp(&b.log_posterior);
        self.evaluated.values().max_by(order)
    }

    fn next(&self) -> Option<Vec<Member>> {
        let least = self.best()?.log_posterior - EXTEND_WITHIN;
        let open = self.evaluated.iter();
        let open =
            open.filter(|(set, v)| v.log_posterior >= least && !self.extended.contains(*set));
        let best = open.max_by(|a, b| {
            let by_value = a.1.log_posterior.total_cmp(&b.1.log_posterior);
            by_value.then_with(|| b.0.cmp(a.0))
        });
        best.map(|(_, evaluated)| evaluated.members.clone())
    }

    /// Extends sets near the best until none is left or `most_extended` were extended. `go_on` is called before each.
    pub fn run(&mut self, most_extended: usize, go_on: &mut dyn FnMut() -> bool) {
        self.reduce_families();
        for _ in 0..most_extended {
            let members = match self.next() {
                Some(members) => members,
                None => {
                    self.split_families();
                    self.reduce_families();
                    let Some(members) = self.next() else {
                        return;
                    };
                    members
                }
            };
            if !go_on() {
                return;
            }
            self.extend(&members, self.best_value());
            for fewer in leave_one_out(&members) {
                if !self.extended.contains(&set_of(&fewer)) {
                    self.evaluate(&fewer);
                    self.extend(&fewer, self.best_value());
                }
            }
        }
    }

    /// Explores sets near one that seems far below the best, because a full fit may show that it is not.
    pub fn explore_around(&mut self, members: &[Member]) {
        let value = self.settle(members);
        if self.best_value() - value < EXTEND_WITHIN {
            return;
        }
        self.extend(members, value);
        for fewer in leave_one_out(members) {
            self.evaluate(&fewer);
            self.extend(&fewer, value);
        }
    }

    /// Log posterior of the best set.
    fn best_value(&self) -> f64 {
        self.best().map_or(f64::NEG_INFINITY, |b| b.log_posterior)
    }

    /// Gains in log posterior by adding each candidate that the set does not exclude; those of at least `least`, largest first.
    fn additions(
        &self,
        system: &System,
        members: &[Member],
        least: f64,
        is_eligible: impl Fn(usize) -> bool,
    ) -> Vec<(f64, Member)> {
        let pool = self.gram.candidates;
        let is_allowed = |index: &usize| {
            let excludes = |m: &Member| pool[*index].excludes(&pool[m.0]);
            is_eligible(*index) && !members.iter().any(excludes)
        };
        let gain = |index: usize| {
            let (gain, scale) = system.gain(self.gram, index, least)?;
            (gain >= least).then_some((gain, (index, scale)))
        };
        let mut gains: Vec<_> = (0..pool.len())
            .filter(is_allowed)
            .filter_map(gain)
            .collect();
        gains.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        gains
    }

    /// Evaluates a set extended by each candidate, discarding extensions far below `best_value`.
    fn extend(&mut self, members: &[Member], best_value: f64) {
        self.extended.insert(set_of(members));
        if members.len() >= self.most {
            return;
        }
        let system = System::extensible(self.gram, members);
        let least = best_value - RECORD_WITHIN - system.log_posterior;
        let additions = self.additions(&system, members, least, |_| true);
        // A gain from the prior odds alone means that the readings speak against the candidate.
        let is_evident =
            |(gain, (index, _)): &(f64, Member)| *gain > system.log_odds(self.gram, *index);
        let evident: Vec<_> = additions.into_iter().filter(is_evident).collect();
        for (gain, member) in evident.into_iter().take(MAX_RECORDED) {
            let mut more = members.to_vec();
            more.push(member);
            self.record(more, system.log_posterior + gain);
        }
        // The sign constraints of the whole set are known only once it is evaluated as a whole.
        if let Some(best) = self.next().filter(|m| m.len() == members.len() + 1) {
            self.settle(&best);
        }
    }

    /// Replaces each cause that explains much by the most probable other effect, even if that is clearly worse here,
    /// because the linear comparison may be wrong by a share of what the cause explains.
    pub fn exchange(&mut self, members: &[Member]) {
        let pool = self.gram.candidates;
        let whole = self.evaluate(members);
        for ((cause, _), mut fewer) in members.iter().zip(leave_one_out(members)) {
            let system = System::extensible(self.gram, &fewer);
            let off = LINEARISATION_ERROR * (whole - system.log_posterior);
            if off < RECORD_WITHIN {
                continue;
            }
            let is_other =
                |index: usize| !std::ptr::eq(pool[index].effect(), pool[*cause].effect());
            let others = self.additions(&system, &fewer, f64::NEG_INFINITY, is_other);
            let Some((gain, other)) = others.first().copied() else {
                continue;
            };
            let value = system.log_posterior + gain;
            self.record(fewer.clone(), system.log_posterior);
            if value > whole - off {
                fewer.push(other);
                self.record(fewer, value);
            }
        }
    }

    /// Replaces each family of the best set by two other causes: one of the most probable replacements, extended by
    /// another cause.
    fn split_families(&mut self) {
        let pool = self.gram.candidates;
        let Some(members) = self.best().map(|b| b.members.clone()) else {
            return;
        };
        for ((family, _), fewer) in members.iter().zip(leave_one_out(&members)) {
            if !pool[*family].is_family() {
                continue;
            }
            let system = System::extensible(self.gram, &fewer);
            let is_single = |index: usize| !pool[index].is_event() && !pool[index].is_family();
            let instead = self.additions(&system, &fewer, f64::NEG_INFINITY, is_single);
            for (_, member) in instead.into_iter().take(MAX_REPLACEMENTS) {
                let mut instead = fewer.clone();
                instead.push(member);
                if !self.extended.contains(&set_of(&instead)) {
                    self.extend(&instead, self.best_value());
                }
            }
        }
    }

    /// Replaces each family of the best sets by single causes on its cables, added one by one in order of their gain.
    fn reduce_families(&mut self) {
        let pool = self.gram.candidates;
        let Some(top) = self.best().map(|b| b.log_posterior) else {
            return;
        };
        let has_family = |evaluated: &&EvaluatedSet| {
            let mut members = evaluated.members.iter();
            evaluated.log_posterior >= top - EXTEND_WITHIN && members.any(|m| pool[m.0].is_family())
        };
        let mut sets: Vec<EvaluatedSet> = self
            .evaluated
            .values()
            .filter(has_family)
            .cloned()
            .collect();
        sets.sort_by(|a, b| {
            let order = b.log_posterior.total_cmp(&a.log_posterior);
            order.then_with(|| a.members.cmp(&b.members))
        });
        for set in sets.into_iter().take(MAX_REDUCED) {
            self.reduce_families_of(&set.members);
        }
    }

    fn reduce_families_of(&mut self, members: &[Member]) {
        let pool = self.gram.candidates;
        for ((family, _), mut fewer) in members.iter().zip(leave_one_out(members)) {
            let family = &pool[*family];
            if !family.is_family() {
                continue;
            }
            let is_member = |index: &usize| {
                let candidate = &pool[*index];
                candidate.is_single() && std::ptr::eq(candidate.effect(), family.effect())
            };
            let mut open: Vec<usize> = (0..pool.len()).filter(is_member).collect();
            while open.len() > 1 && fewer.len() < self.most {
                let range = open[0]..=open[open.len() - 1];
                let system = System::extensible_by(self.gram, &fewer, range);
                let gains = open.iter().filter_map(|index| {
                    let (gain, scale) = system.gain(self.gram, *index, f64::NEG_INFINITY)?;
                    Some((gain, (*index, scale)))
                });
                let best = gains.max_by(|a, b| a.0.total_cmp(&b.0));
                let Some((_, single)) = best.filter(|b| b.0 > 0.0) else {
                    break;
                };
                open.retain(|index| *index != single.0);
                fewer.push(single);
                if !self.evaluated.contains_key(&set_of(&fewer)) {
                    self.settle(&fewer);
                }
            }
        }
    }

    /// Evaluates a set exactly, with optimised scales, and records it.
    pub fn settle(&mut self, members: &[Member]) -> f64 {
        let settled = settled(self.gram, members);
        let value = settled.log_posterior;
        self.evaluated.insert(set_of(members), settled);
        value
    }

    /// Starts with all families and effects of the robot together, and drops the least needed until all that remain are
    /// needed.
    pub fn prune_from_all(&mut self) {
        let pool = self.gram.candidates;
        let wide = |index: &usize| {
            let candidate = &pool[*index];
            let seen = self.gram.scores[*index].information.trace() > 0.0;
            let targeted = candidate.cause.instances.iter().any(|b| b.targeted);
            let direct = candidate
                .columns
                .iter()
                .all(|c| c.pose_weights == PoseWeights::Everywhere);
            seen && direct && (candidate.is_family() || !targeted)
        };
        let mut members: Vec<Member> = Vec::new();
        for index in (0..pool.len()).filter(wide) {
            // A family includes the common value, so it takes precedence.
            members.retain(|m| !(pool[index].is_family() && pool[index].excludes(&pool[m.0])));
            if members.iter().all(|m| !pool[index].excludes(&pool[m.0])) {
                members.push((index, pool[index].scales.len().min(2) - 1));
            }
        }
        let system = System::new(self.gram, &members);
        let mut covariance = system.covariance();
        let mut estimate = system.estimate;
        while members.len() > 1 {
            let mut end = 0;
            let mut least: Option<(f64, usize, std::ops::Range<usize>)> = None;
            for (place, (index, scale)) in members.iter().enumerate() {
                let candidate = &pool[*index];
                let count = candidate.columns.len();
                let block = covariance.view((end, end), (count, count)).into_owned();
                let mean = estimate.rows(end, count);
                let prior = &candidate.prior * candidate.scales[*scale].0;
                let log_prior_sd: f64 = prior.diagonal().map(f64::ln).sum();
                let Some(factor) = block.cholesky() else {
                    return;
                };
                let log_sd: f64 = factor.l_dirty().diagonal().map(f64::ln).sum();
                let square = mean.dot(&factor.solve(&mean));
                let worth = 0.5 * square + log_sd - log_prior_sd
                    + candidate.log_odds
                    + candidate.scales[*scale].1;
                if least.as_ref().is_none_or(|l| worth < l.0) {
                    least = Some((worth, place, end..end + count));
                }
                end += count;
            }
            let Some((worth, place, range)) = least else {
                return;
            };
            if worth >= 0.0 {
                break;
            }
            let kept: Vec<usize> = (0..end).filter(|k| !range.contains(k)).collect();
            let dropped: Vec<usize> = range.collect();
            let inner = covariance.select_rows(&dropped).select_columns(&dropped);
            let cross = covariance.select_rows(&kept).select_columns(&dropped);
            let Some(factor) = inner.cholesky() else {
                return;
            };
            let mean = estimate.select_rows(&dropped);
            estimate = estimate.select_rows(&kept) - &cross * factor.solve(&mean);
            covariance = covariance.select_rows(&kept).select_columns(&kept)
                - &cross * factor.solve(&cross.transpose());
            members.remove(place);
        }
        self.evaluate(&members);
        self.settle(&members);
    }
}

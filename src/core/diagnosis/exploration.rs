//! Explores the probable sets of causes at a fit, over a few points of the hyperparameters.

use std::collections::HashMap;

use super::Stage;
use super::budget::UNEXPLAINED_CHI2;
use super::budget::{
    KEPT_WITHIN, MAX_EXTENDED, MAX_POINTS, MIN_INFORMATION, RIVAL_WITHIN, SETTLED_WITHIN,
};
use super::calibration::LINEARISATION_ERROR;
use super::evidence::{Member, System};
use super::gram::Gram;
use super::hyperparameters::{Hyperparameters, Start};
use super::linear_fit::{LinearFit, OwnEvidence};
use super::progress::Reporter;
use super::relations::is_same_effect_and_targets;
use super::report::Cause;
use super::search::{CandidateSet, EvaluatedSet, Search, set_of, settled};
use crate::statistics::log_sum;

/// Visibility of one cause in the data; for events and waves at the pose or period where it is best.
#[derive(Debug, Clone)]
pub(super) struct Visibility {
    pub cause: Cause,
    /// Whether any reading depends on the cause.
    pub is_read: bool,
    /// Standard deviation of the first parameter with all others estimated; `None` if the data do not determine it.
    pub sd: Option<f64>,
}

/// The search at one point of the hyperparameters.
struct HyperparameterPoint<'l> {
    hyper: Hyperparameters,
    gram: Gram<'l>,
    /// Log evidence without causes, including the prior of the point.
    log_evidence_of_none: f64,
    evaluated: HashMap<CandidateSet, EvaluatedSet>,
    /// Log posteriors of sets found at other points, without the sum over scales.
    log_posteriors: HashMap<Vec<Member>, f64>,
}

impl HyperparameterPoint<'_> {
    /// Log posterior of a set, without the sum over scales.
    fn log_posterior(&mut self, members: &[Member]) -> f64 {
        if let Some(known) = self.log_posteriors.get(members) {
            return *known;
        }
        let value = System::new(&mut self.gram, members).log_posterior;
        self.log_posteriors.insert(members.to_vec(), value);
        value
    }
}

/// The sets explored at one fit.
pub(super) struct Exploration<'l> {
    pub visibility: Vec<Visibility>,
    /// Members and log posterior of each set, best first.
    pub ranking: Vec<(Vec<Member>, f64)>,
    /// All candidates at the hyperparameters estimated for the best set.
    pub gram: Gram<'l>,
}

/// Explores sets at a fit whose own evidence is known. At the first fit of a diagnosis, the search is also started with
/// all families together.
pub(super) fn explore<'l>(
    linear_fit: &'l LinearFit<'_, '_>,
    own_evidence: OwnEvidence<'l>,
    start: Start<'_>,
    (most, is_first): (usize, bool),
    report: &mut Reporter<'_, '_>,
) -> Exploration<'l> {
    let own_hyper = own_evidence.hyper;
    let described = linear_fit.linear.described(own_hyper.factor);
    let mut own_gram = Some(own_evidence.gram);
    let mut pending = vec![own_hyper.clone()];
    let misfit = linear_fit.fit.chi2_per_freedom();
    // With the described noise far too small, every candidate would seem to be a cause.
    if own_hyper.is_far_from(&described) && misfit < UNEXPLAINED_CHI2 {
        pending.push(described);
    }
    let mut points: Vec<HyperparameterPoint<'_>> = Vec::new();
    let mut best: Vec<Member> = linear_fit.present.clone();
    let mut best_hyper = own_hyper.clone();
    while let Some(hyper) = pending.pop() {
        let reused = own_gram.take_if(|_| hyper == own_hyper);
        let mut gram = reused.unwrap_or_else(|| linear_fit.gram(&hyper));
        let log_evidence_of_none = gram.base.log_evidence + hyper.log_prior;
        let mut search = Search::new(&mut gram, most);
        search.evaluate(&[]);
        search.settle(&linear_fit.present);
        search.settle(&best);
        for point in &points {
            if let Some(top) = point
                .evaluated
                .values()
                .max_by(|a, b| a.log_posterior.total_cmp(&b.log_posterior))
            {
                search.settle(&top.members);
            }
        }
        let findings = linear_fit.present.len();
        search.run(MAX_EXTENDED, &mut || report.stage(Stage::Scores, findings));
        let has_several = search.best().is_some_and(|best| best.members.len() > 2);
        if !report.cancelled && (hyper.is_noisy() || is_first && points.is_empty() && has_several) {
            search.prune_from_all();
            search.run(MAX_EXTENDED, &mut || report.stage(Stage::Scores, findings));
        }
        if !report.cancelled {
            search.explore_around(&linear_fit.present);
            search.exchange(&linear_fit.present);
            if let Some(top) = search.best().map(|best| best.members.clone()) {
                search.exchange(&top);
            }
        }
        let evaluated = search.evaluated;
        points.push(HyperparameterPoint {
            hyper,
            gram,
            log_evidence_of_none,
            evaluated,
            log_posteriors: HashMap::new(),
        });
        if !pending.is_empty() {
            continue;
        }
        let ranking = ranked(&mut points, SETTLED_WITHIN, &linear_fit.present);
        let Some((members, _)) = ranking.first() else {
            break;
        };
        let is_new = members != &best || points.len() <= 2 && members != &linear_fit.present;
        best.clone_from(members);
        if is_new && points.len() < MAX_POINTS && !report.cancelled {
            let next = linear_fit.estimate(start, &best).hyper;
            let last = points.last().map(|point| &point.hyper);
            if last.is_some_and(|last| next.is_far_from(last)) {
                pending.push(next.clone());
            }
            best_hyper = next;
        }
    }
    let visibility = points
        .first()
        .map_or_else(Vec::new, |point| visibility(&point.gram));
    let ranking = ranked(&mut points, KEPT_WITHIN, &linear_fit.present);
    let gram = points.into_iter().find(|point| point.hyper == best_hyper);
    Exploration {
        visibility,
        ranking,
        gram: gram.map_or_else(|| linear_fit.gram(&best_hyper), |point| point.gram),
    }
}

/// Sums the posterior of each set over all points and sorts. Sets are kept down to a limit below the present set, since
/// sets that look better than it may turn out worse when they are fitted.
fn ranked(
    points: &mut [HyperparameterPoint<'_>],
    counted: f64,
    present: &[Member],
) -> Vec<(Vec<Member>, f64)> {
    // The point at which each set is best.
    let mut best: HashMap<CandidateSet, (usize, f64)> = HashMap::new();
    for (place, point) in points.iter().enumerate() {
        for (set, evaluated) in &point.evaluated {
            let value = point.log_evidence_of_none + evaluated.log_posterior;
            let entry = best.entry(set.clone()).or_insert((place, value));
            if value > entry.1 {
                *entry = (place, value);
            }
        }
    }
    let values = best.values().map(|(_, value)| *value);
    let top = values.fold(f64::NEG_INFINITY, f64::max);
    let present = set_of(present);
    let least = best.get(&present).map_or(top, |(_, value)| *value);
    let mut ranking: Vec<(Vec<Member>, f64)> = Vec::new();
    let order = |a: &(&CandidateSet, &(usize, f64)), b: &(&CandidateSet, &(usize, f64))| {
        a.1.1.total_cmp(&b.1.1).then_with(|| b.0.cmp(a.0))
    };
    let mut rivals: Vec<CandidateSet> = Vec::new();
    if counted >= KEPT_WITHIN {
        let likeliest = best.iter().max_by(order).map(|(set, _)| set.clone());
        for causes in likeliest.iter().chain([&present]) {
            let Some((_, log_posterior)) = best.get(causes) else {
                continue;
            };
            for cause in causes {
                // A full fit may raise the most probable set without one of the causes.
                let without = |(set, (_, value)): &(&CandidateSet, &(usize, f64))| {
                    *value > log_posterior - RIVAL_WITHIN && !set.contains(cause)
                };
                // The linear comparison is less accurate for causes that explain much.
                let others: CandidateSet = causes.iter().copied().filter(|c| c != cause).collect();
                let explained = best.get(&others).map_or(0.0, |(_, v)| log_posterior - v);
                let exchanged = |(set, (_, value)): &(&CandidateSet, &(usize, f64))| {
                    *value > log_posterior - LINEARISATION_ERROR * explained
                        && set.len() == causes.len()
                        && !set.contains(cause)
                        && others.iter().all(|other| set.contains(other))
                };
                let without = best.iter().filter(without).max_by(order);
                let exchanged = best.iter().filter(exchanged).max_by(order);
                let both = without.into_iter().chain(exchanged);
                rivals.extend(both.map(|(set, _)| set.clone()));
            }
        }
    }
    for (set, (place, value)) in best {
        if value < least - counted && !rivals.contains(&set) {
            continue;
        }
        let mut evaluated = points[place].evaluated[&set].clone();
        if value > least - SETTLED_WITHIN && evaluated.over_scales.is_none() {
            // Members still have the scales that suited the smaller set to which they were added.
            evaluated = settled(&mut points[place].gram, &evaluated.members);
            points[place].evaluated.insert(set, evaluated.clone());
        }
        let log_posteriors = points.iter_mut().enumerate().map(|(k, point)| {
            let log_posterior = if k == place {
                evaluated.log_posterior
            } else {
                point.log_posterior(&evaluated.members) + evaluated.over_scales.unwrap_or(0.0)
            };
            point.log_evidence_of_none + log_posterior
        });
        let total = log_sum(log_posteriors);
        ranking.push((evaluated.members, total));
    }
    ranking.sort_by(|a, b| b.1.total_cmp(&a.1).then_with(|| a.0.cmp(&b.0)));
    ranking
}

/// Visibility of each single cause in the data.
pub(super) fn visibility(gram: &Gram<'_>) -> Vec<Visibility> {
    let mut visible: Vec<Visibility> = Vec::new();
    for (candidate, candidate_score) in gram.candidates.iter().zip(&gram.scores) {
        if candidate.is_family() {
            continue;
        }
        let information = candidate_score.information[(0, 0)];
        let scaled = information * candidate.prior[(0, 0)].powi(2);
        let sd = (scaled > MIN_INFORMATION).then(|| information.sqrt().recip());
        // The score of a zero column is exactly zero, while rounding may leave some information.
        let is_read = candidate_score.score.iter().any(|s| *s != 0.0);
        match visible.last_mut() {
            Some(last) if is_same_effect_and_targets(&last.cause, &candidate.cause) => {
                last.is_read |= is_read;
                last.sd = match (last.sd, sd) {
                    (Some(a), Some(b)) => Some(a.min(b)),
                    (a, b) => a.or(b),
                };
            }
            _ => visible.push(Visibility {
                cause: candidate.cause.clone(),
                is_read,
                sd,
            }),
        }
    }
    visible
}

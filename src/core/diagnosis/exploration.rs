//! Explores the probable sets of causes at a fit, over a few points of the hyperparameters.

use std::collections::HashMap;

use super::Stage;
use super::candidates::is_alike;
use super::complete::RIVAL;
use super::evidence::{Member, System};
use super::gram::Gram;
use super::hyperparameters::Hyperparameters;
use super::linear_fit::LinearFit;
use super::progress::Reporter;
use super::report::Cause;
use super::search::{INEXACT, Search, Set, Visited, set_of, settled};

/// Maximum number of points at each fit.
const MOST_POINTS: usize = 5;
/// Maximum number of sets that each search extends.
pub(super) const MOST_EXTENDED: usize = 40;
/// Chi-square per degree of freedom above which the described noise is no sensible point.
pub(super) const UNEXPLAINED: f64 = 100.0;
/// Log posterior below the best down to which sets are kept.
const COUNTED: f64 = 12.0;
/// Log posterior below the best down to which the scales of a set are optimised again.
const WORTH_SETTLING: f64 = 8.0;
/// Information relative to that of the prior below which the data do not determine a parameter.
const SEEN: f64 = 1e-2;

/// How well the data show one cause; for events and waves at the pose or period that shows them best.
#[derive(Debug, Clone)]
pub(super) struct Visibility {
    pub cause: Cause,
    /// Whether any reading depends on it.
    pub is_read: bool,
    /// Standard deviation of its first parameter with all else estimated; `None` if the data do not determine it.
    pub sd: Option<f64>,
}

/// The search at one point of the hyperparameters.
struct Point<'l> {
    gram: Gram<'l>,
    /// Log evidence without causes, including the prior of the point.
    of_none: f64,
    visited: HashMap<Set, Visited>,
}

/// The sets explored at one fit.
pub(super) struct Explored {
    pub visibility: Vec<Visibility>,
    /// Members and log posterior of each set, best first.
    pub ranking: Vec<(Vec<Member>, f64)>,
    /// Hyperparameters estimated for the best set.
    pub at: Hyperparameters,
}

pub(super) fn log_sum(values: impl Iterator<Item = f64>) -> f64 {
    let values: Vec<f64> = values.collect();
    let largest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if largest == f64::NEG_INFINITY {
        return largest;
    }
    largest + values.iter().map(|v| (v - largest).exp()).sum::<f64>().ln()
}

/// Explores sets at a fit, starting with the hyperparameters `own`. At the first fit of a diagnosis, the search is also
/// started with all families together.
pub(super) fn explore(
    at: &LinearFit<'_, '_>,
    own: Hyperparameters,
    (most, is_first): (usize, bool),
    report: &mut Reporter<'_, '_>,
) -> Explored {
    let described = at.linear.described();
    let mut asked = vec![own.clone()];
    let left = at.fit.solution.chi2 / at.fit.solution.degrees_of_freedom;
    // With the described noise far too small, every candidate would seem to be a cause.
    if own.is_far_from(&described) && left < UNEXPLAINED {
        asked.push(described);
    }
    let mut points: Vec<Point<'_>> = Vec::new();
    let mut best: Vec<Member> = at.present.clone();
    let mut found = own;
    while let Some(hyper) = asked.pop() {
        let mut gram = at.gram(&hyper);
        let of_none = gram.base.log_evidence + hyper.log_prior;
        let mut search = Search::new(&mut gram, most);
        search.visit(&[]);
        search.settle(&at.present);
        search.settle(&best);
        for point in &points {
            if let Some(top) = point
                .visited
                .values()
                .max_by(|a, b| a.log_posterior.total_cmp(&b.log_posterior))
            {
                search.settle(&top.members);
            }
        }
        let findings = at.present.len();
        search.run(MOST_EXTENDED, &mut || report.stage(Stage::Scores, findings));
        if hyper.is_loud()
            || is_first && points.is_empty() && search.best().is_some_and(|b| b.members.len() > 2)
        {
            search.drop_from_all();
            search.run(MOST_EXTENDED, &mut || report.stage(Stage::Scores, findings));
        }
        search.around(&at.present);
        search.exchange(&at.present);
        if let Some(top) = search.best().map(|best| best.members.clone()) {
            search.exchange(&top);
        }
        let visited = search.visited;
        points.push(Point {
            gram,
            of_none,
            visited,
        });
        if !asked.is_empty() {
            continue;
        }
        let ranking = ranked(&mut points, WORTH_SETTLING, &at.present);
        let Some((members, _)) = ranking.first() else {
            break;
        };
        let is_new = members != &best || points.len() <= 2 && members != &at.present;
        best.clone_from(members);
        if is_new && points.len() < MOST_POINTS && !report.cancelled {
            let next = at.estimate(&best);
            if next.is_far_from(&hyper) {
                asked.push(next.clone());
            }
            found = next;
        }
    }
    Explored {
        visibility: points
            .first()
            .map_or_else(Vec::new, |point| visibility(&point.gram)),
        ranking: ranked(&mut points, COUNTED, &at.present),
        at: found,
    }
}

/// Sums the posterior of each set over all points and sorts. Sets are kept down to a limit below the present set, since
/// sets that look better than it may turn out worse when they are fitted.
fn ranked(points: &mut [Point<'_>], counted: f64, present: &[Member]) -> Vec<(Vec<Member>, f64)> {
    // The point at which each set is best.
    let mut best: HashMap<Set, (usize, f64)> = HashMap::new();
    for (place, point) in points.iter().enumerate() {
        for (set, visited) in &point.visited {
            let value = point.of_none + visited.log_posterior;
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
    let order = |a: &(&Set, &(usize, f64)), b: &(&Set, &(usize, f64))| {
        a.1.1.total_cmp(&b.1.1).then_with(|| b.0.cmp(a.0))
    };
    let mut rivals: Vec<Set> = Vec::new();
    if counted >= COUNTED {
        let likeliest = best.iter().max_by(order).map(|(set, _)| set.clone());
        for causes in likeliest.iter().chain([&present]) {
            let Some((_, own)) = best.get(causes) else {
                continue;
            };
            for cause in causes {
                // A full fit may raise the most probable set without one of the causes.
                let without = |(set, (_, value)): &(&Set, &(usize, f64))| {
                    *value > own - RIVAL && !set.contains(cause)
                };
                // The linear comparison is less accurate for causes that explain much.
                let others: Set = causes.iter().copied().filter(|c| c != cause).collect();
                let explained = best.get(&others).map_or(0.0, |(_, value)| own - value);
                let exchanged = |(set, (_, value)): &(&Set, &(usize, f64))| {
                    *value > own - INEXACT * explained
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
        let mut visited = points[place].visited[&set].clone();
        if value > least - WORTH_SETTLING {
            // Members still have the scales that suited the smaller set to which they were added.
            visited = settled(&mut points[place].gram, &visited.members);
        }
        let all = points.iter_mut().enumerate().map(|(k, point)| {
            let own = if k == place {
                visited.log_posterior
            } else {
                System::new(&mut point.gram, &visited.members).log_posterior + visited.over_scales
            };
            point.of_none + own
        });
        let total = log_sum(all);
        ranking.push((visited.members, total));
    }
    ranking.sort_by(|a, b| b.1.total_cmp(&a.1).then_with(|| a.0.cmp(&b.0)));
    ranking
}

/// How well the data show each single cause.
pub(super) fn visibility(gram: &Gram<'_>) -> Vec<Visibility> {
    let mut found: Vec<Visibility> = Vec::new();
    for (candidate, own) in gram.candidates.iter().zip(&gram.own) {
        if candidate.is_family() {
            continue;
        }
        let information = own.information[(0, 0)];
        let scaled = information * candidate.prior[(0, 0)].powi(2);
        let sd = (scaled > SEEN).then(|| information.sqrt().recip());
        // The score of a zero column is exactly zero, while rounding may leave some information.
        let is_read = own.score.iter().any(|s| *s != 0.0);
        match found.last_mut() {
            Some(last) if is_alike(&last.cause, &candidate.cause) => {
                last.is_read |= is_read;
                last.sd = match (last.sd, sd) {
                    (Some(a), Some(b)) => Some(a.min(b)),
                    (a, b) => a.or(b),
                };
            }
            _ => found.push(Visibility {
                cause: candidate.cause.clone(),
                is_read,
                sd,
            }),
        }
    }
    found
}

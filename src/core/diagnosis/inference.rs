//! From readings to the posterior probabilities of sets of causes.
//!
//! At a fit, all readings are linear in the parameters of all candidates. Sets are compared there at a few points of the
//! hyperparameters: noise as described, and the estimates for the sets that were best; the probability of a set is the
//! sum over the points, so that a small cause in small noise competes with no cause in large noise. The likeliest sets are
//! then fitted completely and compared by the evidence at their own fits; at the best of them everything is linearised
//! again, until it stays the best.

use std::collections::HashMap;

use nalgebra::{DMatrix, DVector};

use super::background::shapes;
use super::candidates::{Candidate, Catalogue, is_alike};
use super::conditions::Conditions;
use super::evidence::{Member, System};
use super::fit::Fit;
use super::gram::Gram;
use super::hyperparameters::{Hyperparameters, Linear};
use super::progress::Reporter;
use super::report::Cause;
use super::search::{Search, Set, Visited};
use super::variables::Variables;
use super::{DiagnosisOptions, Stage};
use crate::effect::{BoundEffect, Search as EffectSearch};
use crate::estimation::{EstimationError, Linearisation, ParameterId, Problem};

/// Causes expected beforehand, for each unit of the probability of a false finding that is allowed.
pub(super) const EXPECTED_PER_ALPHA: f64 = 80.0;
/// Most linearisations, and most points of the hyperparameters at each.
const MOST_LINEARISATIONS: usize = 5;
const MOST_POINTS: usize = 5;
/// Most sets that are extended in each search.
const MOST_EXTENDED: usize = 40;
/// Sets that are fitted completely, and how far below the best.
const MOST_REFITS: usize = 5;
const REFITTED: f64 = 5.0;
/// Chi-square per degree of freedom from which more causes are fitted, and at most how many at each point.
const DOMINATED: f64 = 5.0;
const MOST_EXTENSIONS: usize = 8;
/// Difference of the logarithm of the posterior up to which a set counts.
const COUNTED: f64 = 12.0;
/// Information, in units of the prior's, below which the data say nothing of a parameter.
const SEEN: f64 = 1e-2;
/// Sizes over the largest typical one that no cause has.
const ABSURD: f64 = 10.0;

/// A set of causes with its posterior.
#[derive(Debug, Clone)]
pub(super) struct Ranked {
    pub causes: Vec<Cause>,
    pub log_posterior: f64,
}

/// What was inferred.
pub(super) struct Inference<'a> {
    /// The fit of the likeliest set.
    pub fit: Fit<'a>,
    /// Sets, the likeliest first, which is that of the fit.
    pub ranking: Vec<Ranked>,
    /// The problem linearised at the fit, with the hyperparameters estimated there.
    pub linear: Linear,
    pub at: Hyperparameters,
    /// Columns of the causes of the fit in units of their prior.
    pub columns: DMatrix<f64>,
    catalogue: Catalogue,
    present: Vec<Member>,
    generators: DMatrix<f64>,
}

/// How well the data show one cause, at its most visible place if it is an event or a wave.
#[derive(Debug, Clone)]
pub(super) struct Visibility {
    pub cause: Cause,
    /// Whether any reading depends on it.
    pub is_read: bool,
    /// Standard deviation of its first parameter, everything else estimated; `None` where the data say nothing.
    pub sd: Option<f64>,
}

impl Inference<'_> {
    /// Standard deviations of the columns' parameters of each cause, in the noise and the background that there is, over
    /// those in the noise as described.
    pub fn spread(&self) -> Vec<Vec<f64>> {
        let variance = |at: &Hyperparameters| {
            let none = DMatrix::zeros(self.linear.conditions.count, 0);
            let base = self.linear.base(at, &none);
            let mut gram = Gram::new(&self.linear, base, &self.catalogue, &self.generators);
            System::new(&mut gram, &self.present).covariance.diagonal()
        };
        let (is, described) = (variance(&self.at), variance(&self.linear.described()));
        let mut at = 0;
        let of = |(index, _): &Member| {
            let count = self.catalogue.candidates[*index].columns.len();
            let ratio = |k: usize| (is[k] / described[k]).sqrt();
            let own = (at..at + count).map(ratio).collect();
            at += count;
            own
        };
        self.present.iter().map(of).collect()
    }
}

/// A fit with its linear problem.
pub(super) struct At<'f, 'a> {
    fit: &'f Fit<'a>,
    pub linear: Linear,
    pub catalogue: Catalogue,
    /// The generators in conditions.
    generators: DMatrix<f64>,
    /// The members that are the causes of the fit.
    present: Vec<Member>,
}

impl<'f, 'a> At<'f, 'a> {
    pub fn new(fit: &'f Fit<'a>, expected: f64, is_all: bool) -> Self {
        let linear = Linearisation::new(&fit.problem, &fit.solution);
        let catalogue = Catalogue::new(fit, &linear, expected, is_all);
        let conditions = Conditions::new(&linear);
        let variables = Variables::new(&fit.problem, &fit.solution, &linear);
        let shapes = shapes(&conditions, &linear, &variables);
        let is_fixed = |k: &usize| !matches!(linear.parameters[*k].id, ParameterId::Effect { .. });
        let fixed: Vec<usize> = (0..linear.parameters.len()).filter(is_fixed).collect();
        let fixed = conditions.of_rows(&linear.design.select_columns(&fixed));
        let generators = conditions.of_rows(&catalogue.generators);
        let residual =
            DMatrix::from_column_slice(linear.residual.len(), 1, linear.residual.as_slice());
        let mut residual: DVector<f64> = conditions.of_rows(&residual).column(0).into_owned();
        let mut present = Vec::new();
        let poses = conditions.poses;
        for cause in &fit.causes {
            let Some(index) = catalogue.candidates.iter().position(|c| c.is_of(cause)) else {
                continue;
            };
            let candidate = &catalogue.candidates[index];
            let coordinates = candidate.coordinates(cause);
            for (k, value) in coordinates.iter().enumerate() {
                let column = catalogue.column(candidate.columns[k], &generators, &conditions);
                residual.axpy(-value, &column, 1.0);
            }
            present.push((index, candidate.nearest_scale(&coordinates)));
        }
        debug_assert!(poses == linear.poses.len());
        Self {
            fit,
            linear: Linear {
                conditions,
                residual,
                fixed,
                shapes,
            },
            catalogue,
            generators,
            present,
        }
    }

    /// Columns of members in conditions, in units of their prior.
    pub fn columns(&self, members: &[Member]) -> DMatrix<f64> {
        let mut parts = Vec::new();
        for (index, scale) in members {
            let candidate = &self.catalogue.candidates[*index];
            let mut columns = DMatrix::zeros(self.linear.conditions.count, candidate.columns.len());
            for (k, column) in candidate.columns.iter().enumerate() {
                let column =
                    self.catalogue
                        .column(*column, &self.generators, &self.linear.conditions);
                columns.set_column(k, &column);
            }
            parts.push(columns * &candidate.prior * candidate.scales[*scale].0);
        }
        let width = parts.iter().map(DMatrix::ncols).sum();
        let mut all = DMatrix::zeros(self.linear.conditions.count, width);
        let mut first = 0;
        for part in parts {
            all.columns_mut(first, part.ncols()).copy_from(&part);
            first += part.ncols();
        }
        all
    }

    /// The hyperparameters that suit a set, from the noise as described: from louder noise the estimation would stay there.
    fn estimate(&self, members: &[Member]) -> Hyperparameters {
        self.linear
            .estimate(&self.linear.described(), &self.columns(members))
    }

    pub fn gram(&self, at: &Hyperparameters) -> Gram<'_> {
        let none = DMatrix::zeros(self.linear.conditions.count, 0);
        Gram::new(
            &self.linear,
            self.linear.base(at, &none),
            &self.catalogue,
            &self.generators,
        )
    }

    /// The evidence of the causes of the fit at it, its prior included, with the hyperparameters that suit it.
    fn own_evidence(&self) -> (f64, Hyperparameters) {
        let at = self.estimate(&self.present);
        let mut gram = self.gram(&at);
        let of_none = gram.base.log_evidence + at.log_prior;
        let mut search = Search::new(&mut gram, self.present.len());
        let value = search.settle(&self.present);
        (of_none + value, at)
    }
}

/// One point of the hyperparameters.
struct Point<'l> {
    gram: Gram<'l>,
    /// Logarithm of the evidence without causes, and of the prior of the point.
    of_none: f64,
    visited: HashMap<Set, Visited>,
}

/// The sets that were looked at from one fit.
struct Explored {
    visibility: Vec<Visibility>,
    /// Members and logarithm of the posterior, the best first.
    ranking: Vec<(Vec<Member>, f64)>,
    /// Hyperparameters of the best.
    at: Hyperparameters,
}

fn log_sum(values: impl Iterator<Item = f64>) -> f64 {
    let values: Vec<f64> = values.collect();
    let largest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if largest == f64::NEG_INFINITY {
        return largest;
    }
    largest + values.iter().map(|v| (v - largest).exp()).sum::<f64>().ln()
}

fn explore(at: &At<'_, '_>, most: usize, report: &mut Reporter<'_, '_>) -> Explored {
    let described = at.linear.described();
    let own = at.estimate(&at.present);
    let mut asked = vec![own.clone()];
    if own.is_far_from(&described) {
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
            || points.is_empty() && search.best().is_some_and(|b| b.members.len() > 2)
        {
            search.drop_from_all();
            search.run(MOST_EXTENDED, &mut || report.stage(Stage::Scores, findings));
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
        let ranking = ranked(&mut points);
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
        ranking: ranked(&mut points),
        at: found,
    }
}

/// The best sets, and the best with so many causes, one for each effect on one cable, on all and on each.
fn diverse(
    candidates: &[Candidate],
    visited: &HashMap<Set, Visited>,
    count: usize,
) -> Vec<Vec<Member>> {
    let mut all: Vec<&Visited> = visited.values().collect();
    all.sort_by(|a, b| {
        let order = b.log_posterior.total_cmp(&a.log_posterior);
        order.then_with(|| a.members.cmp(&b.members))
    });
    let mut found: Vec<Vec<Member>> = all
        .iter()
        .take(MOST_REFITS)
        .map(|v| v.members.clone())
        .collect();
    let kind = |members: &[Member]| {
        let last = members.last().map(|m| &candidates[m.0]);
        last.map(|c| {
            (
                c.effect().id(),
                c.is_family(),
                c.cause.instances[0].targeted,
            )
        })
    };
    let mut kinds = Vec::new();
    for visited in all.iter().filter(|v| v.members.len() == count) {
        let own = kind(&visited.members);
        if kinds.len() < MOST_EXTENSIONS && !kinds.contains(&own) {
            kinds.push(own);
            found.push(visited.members.clone());
        }
    }
    found
}

/// Takes in what explains most of chi-square where that is far from what noise makes: there all is nonlinear, so that
/// each kind of cause is worth a fit, and the noise is as large as what is left.
fn approach<'a>(
    from: Fit<'a>,
    seen: &mut Option<Vec<Visibility>>,
    options: &DiagnosisOptions,
    report: &mut Reporter<'_, '_>,
) -> Result<Fit<'a>, EstimationError> {
    let expected = EXPECTED_PER_ALPHA * options.alpha;
    let mut problem = from.problem.clone();
    problem.free_effects.clear();
    let mut fit = from;
    for _ in 0..options.most_findings {
        let left = fit.solution.chi2 / fit.solution.degrees_of_freedom;
        if left < DOMINATED || !left.is_finite() || !report.stage(Stage::Refits, fit.causes.len()) {
            break;
        }
        let at = At::new(&fit, expected, true);
        let hyper = at.linear.louder(left);
        let mut gram = at.gram(&hyper);
        seen.get_or_insert_with(|| visibility(&at.gram(&at.linear.described())));
        let candidates = &at.catalogue.candidates;
        let mut search = Search::new(&mut gram, options.most_findings);
        search.settle(&at.present);
        let findings = at.present.len();
        search.run(MOST_EXTENDED / 2, &mut || {
            report.stage(Stage::Scores, findings)
        });
        search.drop_from_all();
        let visited = search.visited;
        let price = (at.linear.conditions.count as f64).ln();
        // Noise of the size of what is left, a price for each parameter (Schwarz 1978) and the prior of the set.
        let score = |fit: &Fit<'_>, members: &[Member]| {
            let freedom = fit.solution.degrees_of_freedom.max(1.0);
            let likelihood = freedom * (fit.solution.chi2 / freedom).max(1.0).ln();
            let odds: f64 = members.iter().map(|m| candidates[m.0].log_odds).sum();
            odds - 0.5 * (likelihood + price * fit.parameters() as f64)
        };
        let mut best: Option<(f64, Fit<'a>)> = None;
        for members in diverse(candidates, &visited, findings + 1) {
            if same_members(&members, &at.present) || report.cancelled {
                continue;
            }
            let refit = Fit::new(&problem, &causes_of(&at, &hyper, &members))?;
            let value = score(&refit, &members);
            if is_possible(&refit) && best.as_ref().is_none_or(|b| value > b.0) {
                best = Some((value, refit));
            }
        }
        let own = score(&fit, &at.present);
        match best {
            Some((value, better)) if value > own => fit = better,
            _ => break,
        }
    }
    Ok(fit)
}

fn same_members(one: &[Member], other: &[Member]) -> bool {
    one.len() == other.len() && one.iter().all(|m| other.iter().any(|o| o.0 == m.0))
}

/// The sets of all points with their posteriors, the best first.
fn ranked(points: &mut [Point<'_>]) -> Vec<(Vec<Member>, f64)> {
    let mut best: HashMap<Set, (Vec<Member>, f64)> = HashMap::new();
    for point in points.iter() {
        for (set, visited) in &point.visited {
            let value = point.of_none + visited.log_posterior;
            let entry = best
                .entry(set.clone())
                .or_insert_with(|| (visited.members.clone(), value));
            if value > entry.1 {
                *entry = (visited.members.clone(), value);
            }
        }
    }
    let top = best
        .values()
        .map(|(_, value)| *value)
        .fold(f64::NEG_INFINITY, f64::max);
    let mut ranking: Vec<(Vec<Member>, f64)> = Vec::new();
    for (set, (members, value)) in best {
        if value < top - COUNTED {
            continue;
        }
        let all = points.iter_mut().map(|point| {
            let known = point.visited.get(&set).map(|v| v.log_posterior);
            point.of_none
                + known.unwrap_or_else(|| System::new(&mut point.gram, &members).log_posterior)
        });
        let total = log_sum(all);
        ranking.push((members, total));
    }
    ranking.sort_by(|a, b| b.1.total_cmp(&a.1).then_with(|| a.0.cmp(&b.0)));
    ranking
}

/// Whether all values of a fit are physically possible.
fn is_possible(fit: &Fit<'_>) -> bool {
    let bounds = fit.causes.iter().flat_map(|cause| &cause.instances);
    let mut values = bounds.flat_map(|b| b.values.iter().zip(b.effect.parameters()));
    fit.solution.chi2.is_finite()
        && values.all(|(value, p)| {
            let largest = p.typical[0].abs().max(p.typical[1].abs());
            let sized = p.discrete || (value - p.neutral).abs() < ABSURD * largest.max(p.prior_sd);
            sized && *value >= p.bounds[0] && *value <= p.bounds[1]
        })
}

/// The causes of members, estimated at a point of the linear problem.
fn causes_of(at: &At<'_, '_>, hyper: &Hyperparameters, members: &[Member]) -> Vec<Cause> {
    let mut gram = at.gram(hyper);
    let system = System::new(&mut gram, members);
    let candidates = &at.catalogue.candidates;
    let ranges = system.parameters(candidates);
    let mut causes = Vec::new();
    for ((index, _), range) in members.iter().zip(ranges) {
        let estimate: Vec<f64> = system.estimate.rows_range(range).iter().copied().collect();
        // What the fit has already is known better.
        let known = at.present.iter().position(|m| m.0 == *index);
        causes.push(match known {
            Some(k) => at.fit.causes[k].clone(),
            None => candidates[*index].estimated(&estimate),
        });
    }
    causes
}

/// How well single causes are seen.
fn visibility(gram: &Gram<'_>) -> Vec<Visibility> {
    let mut found: Vec<Visibility> = Vec::new();
    for (candidate, own) in gram.candidates.iter().zip(&gram.own) {
        if candidate.is_family() {
            continue;
        }
        let information = own.information[(0, 0)];
        let scaled = information * candidate.prior[(0, 0)].powi(2);
        let sd = (scaled > SEEN).then(|| information.sqrt().recip());
        // Columns of zeros have no score, whatever rounding leaves of their information.
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

/// Infers the causes of a problem.
pub(super) fn infer<'a>(
    base: &Problem<'a>,
    options: &DiagnosisOptions,
    report: &mut Reporter<'_, '_>,
) -> Result<(Inference<'a>, Vec<Visibility>), EstimationError> {
    let expected = EXPECTED_PER_ALPHA * options.alpha;
    let none = Fit::new(base, &[])?;
    let mut seen: Option<Vec<Visibility>> = None;
    let mut fit = approach(none, &mut seen, options, report)?;
    let mut tried: Vec<Vec<Cause>> = vec![fit.causes.clone()];
    for round in 1.. {
        let at = At::new(&fit, expected, true);
        let explored = explore(&at, options.most_findings, report);
        let candidates = &at.catalogue.candidates;
        let visible = seen.get_or_insert(explored.visibility);
        let top = explored.ranking.first().map_or(0.0, |(_, value)| *value);
        let causes = |members: &[Member]| -> Vec<Cause> {
            members.iter().map(|m| candidates[m.0].placed()).collect()
        };
        let mut ranking: Vec<Ranked> = explored
            .ranking
            .iter()
            .map(|(members, value)| Ranked {
                causes: causes(members),
                log_posterior: *value,
            })
            .collect();
        report.stage(Stage::Refits, at.present.len());
        // The evidence of the likeliest sets at their own fits.
        let (own, _) = at.own_evidence();
        let mut best: Option<(f64, Fit<'a>)> = None;
        let here = causes(&at.present);
        let offset = explored
            .ranking
            .iter()
            .zip(&ranking)
            .find(|(_, r)| is_same(&r.causes, &here))
            .map_or(0.0, |((_, v), _)| own - v);
        let near = |(_, value): &&(Vec<Member>, f64)| *value >= top - REFITTED;
        let chosen: Vec<&Vec<Member>> = explored
            .ranking
            .iter()
            .filter(near)
            .take(MOST_REFITS)
            .map(|(m, _)| m)
            .collect();
        for (place, members) in chosen.into_iter().enumerate() {
            if report.cancelled && place > 0 {
                break;
            }
            let causes = causes(members);
            if is_same(&causes, &here) {
                continue;
            }
            let start = causes_of(&at, &explored.at, members);
            let refit = Fit::new(base, &start)?;
            let value = if is_possible(&refit) {
                At::new(&refit, expected, false).own_evidence().0
            } else {
                f64::NEG_INFINITY
            };
            match ranking.iter_mut().find(|r| is_same(&r.causes, &causes)) {
                Some(ranked) => ranked.log_posterior = value - offset,
                None => ranking.push(Ranked {
                    causes,
                    log_posterior: value - offset,
                }),
            }
            if best.as_ref().is_none_or(|b| value > b.0) {
                best = Some((value, refit));
            }
        }
        ranking.sort_by(|a, b| b.log_posterior.total_cmp(&a.log_posterior));
        let better = best.filter(|(value, fit)| {
            let seen = tried.iter().any(|t| is_same(t, &fit.causes));
            *value > own && !seen && round < MOST_LINEARISATIONS
        });
        match better {
            Some((_, next)) if !report.cancelled || fit.causes.is_empty() => {
                tried.push(next.causes.clone());
                fit = next;
            }
            _ => {
                let united = united(&fit).filter(|_| round < MOST_LINEARISATIONS);
                let united = united.map(|causes| Fit::new(base, &causes)).transpose()?;
                let better = united.filter(|fit| {
                    is_possible(fit) && At::new(fit, expected, false).own_evidence().0 > own
                });
                match better {
                    Some(next) => fit = next,
                    None => return Ok((at_fit(fit, options, ranking), std::mem::take(visible))),
                }
            }
        }
    }
    unreachable!("the last round returns")
}

/// The causes of a fit with those of the same effect on several single cables replaced by one with a common value.
fn united(fit: &Fit<'_>) -> Option<Vec<Cause>> {
    if let Some(causes) = shared_by_some(fit) {
        return Some(causes);
    }
    let is_single = |cause: &Cause| match cause.instances.as_slice() {
        [bound] => {
            bound.targeted
                && bound.cables.len() == 1
                && bound.effect.search() == EffectSearch::Direct
        }
        _ => false,
    };
    let singles = || fit.causes.iter().filter(|c| is_single(c));
    let same = |one: &Cause, other: &Cause| std::ptr::eq(one.effect(), other.effect());
    let several = |cause: &&Cause| singles().filter(|c| same(c, cause)).count() > 1;
    let effect = singles().find(several)?;
    let members: Vec<&Cause> = singles().filter(|c| same(c, effect)).collect();
    let mut cables: Vec<usize> = members.iter().flat_map(|c| c.cables()).collect();
    cables.sort_unstable();
    let bound = &members[0].instances[0];
    let mean = |k: usize| {
        let values = members.iter().map(|c| c.instances[0].values[k]);
        values.sum::<f64>() / members.len() as f64
    };
    let common = BoundEffect {
        effect: bound.effect,
        cables,
        targeted: true,
        values: (0..bound.values.len()).map(mean).collect(),
    };
    let others = fit
        .causes
        .iter()
        .filter(|c| !(is_single(c) && same(c, effect)));
    let common = Cause {
        instances: vec![common],
    };
    Some(others.cloned().chain([common]).collect())
}

/// The causes of a fit with a family, of which some cables have about the same value and the others nearly none, replaced
/// by one with a common value on these.
fn shared_by_some(fit: &Fit<'_>) -> Option<Vec<Cause>> {
    for (place, cause) in fit.causes.iter().enumerate() {
        let first = &cause.instances[0];
        if cause.instances.len() < 2 || first.values.len() != 1 {
            continue;
        }
        let neutral = first.effect.parameters()[0].neutral;
        let value = |bound: &BoundEffect| bound.values[0] - neutral;
        let values = || cause.instances.iter().map(value);
        let largest = values().fold(0.0, |a: f64, b| if b.abs() > a.abs() { b } else { a });
        let shares = |bound: &&BoundEffect| value(bound) / largest > 0.5;
        let some: Vec<&BoundEffect> = cause.instances.iter().filter(shares).collect();
        if some.len() < 2 || some.len() == cause.instances.len() {
            continue;
        }
        let mean = some.iter().map(|b| b.values[0]).sum::<f64>() / some.len() as f64;
        let common = BoundEffect {
            effect: first.effect,
            cables: some.iter().flat_map(|b| b.cables.clone()).collect(),
            targeted: true,
            values: vec![mean],
        };
        let mut causes = fit.causes.clone();
        causes[place] = Cause {
            instances: vec![common],
        };
        return Some(causes);
    }
    None
}

/// What is known at a fit.
pub(super) fn at_fit<'a>(
    fit: Fit<'a>,
    options: &DiagnosisOptions,
    mut ranking: Vec<Ranked>,
) -> Inference<'a> {
    let at = At::new(&fit, EXPECTED_PER_ALPHA * options.alpha, false);
    let (_, hyper) = at.own_evidence();
    let columns = at.columns(&at.present);
    // The fit is of the likeliest set, but for rounding of the linear comparison.
    if let Some(own) = ranking.iter().position(|r| is_same(&r.causes, &fit.causes)) {
        let own = ranking.remove(own);
        ranking.insert(
            0,
            Ranked {
                causes: fit.causes.clone(),
                ..own
            },
        );
    }
    let At {
        linear,
        catalogue,
        present,
        generators,
        ..
    } = at;
    Inference {
        ranking,
        linear,
        at: hyper,
        columns,
        catalogue,
        present,
        generators,
        fit,
    }
}

/// The same causes, in whatever order.
pub(super) fn is_same(one: &[Cause], other: &[Cause]) -> bool {
    let contains = |all: &[Cause], cause: &Cause| all.iter().any(|c| is_same_cause(c, cause));
    one.len() == other.len() && one.iter().all(|cause| contains(other, cause))
}

/// Same effect and targets; an event at the same pose.
pub(super) fn is_same_cause(one: &Cause, other: &Cause) -> bool {
    let pose = one.effect().pose_parameter();
    is_alike(one, other)
        && pose.is_none_or(|k| one.instances[0].values[k] == other.instances[0].values[k])
}

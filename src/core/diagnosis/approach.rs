//! Stepwise nonlinear fits for data whose chi-square is far above its degrees of freedom.

use std::collections::HashMap;

use super::candidates::Candidate;
use super::evidence::Member;
use super::exploration::{MOST_EXTENDED, UNEXPLAINED, Visibility, visibility};
use super::fit::Fit;
use super::inference::{causes_of, is_possible};
use super::linear_fit::{EXPECTED_PER_ALPHA, LinearFit};
use super::progress::Reporter;
use super::search::{Search, Set, Visited};
use super::{DiagnosisOptions, Stage};
use crate::estimation::EstimationError;

/// Chi-square per degree of freedom above which sets are compared by full fits rather than in the linearised problem.
const DOMINATED: f64 = 5.0;
/// Number of sets that are fitted in each step: the best ones, and the best of each kind that has one cause more.
const MOST_CONTINUED: usize = 5;
const MOST_EXTENSIONS: usize = 8;

/// The best sets, and for variety the best set with `count` causes of each kind. The kind is that of the last cause:
/// its effect, and whether it acts on one cable, on all alike or on each with its own value.
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
        .take(MOST_CONTINUED)
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

/// Adds the causes that explain most of chi-square, one per step, as long as chi-square is far above its degrees of
/// freedom. The linear comparison is useless there, so one cause of each kind is fitted, with noise of the size of the
/// residuals.
pub(super) fn approach<'a>(
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
        let at = LinearFit::new(&fit, expected, true);
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
        // Log-likelihood with the noise scaled to the residuals, with the BIC penalty for parameters (Schwarz 1978) and
        // the prior of the set.
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
            let causes = causes_of(&at, &mut gram, &members);
            let refit = if left < UNEXPLAINED {
                Fit::new(&problem, &causes)?
            } else {
                Fit::to_the_end(&problem, &causes)?
            };
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

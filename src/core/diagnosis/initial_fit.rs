//! Stepwise nonlinear fits for data whose chi-square is far above its degrees of freedom.

use std::collections::HashMap;
use std::rc::Rc;

use super::budget::{
    FAR_FROM_NOISE, MAX_BEST_SETS, MAX_EXTENDED, MAX_KINDS, PATIENCE_FAR_FROM_NOISE,
    UNEXPLAINED_CHI2,
};
use super::candidates::Candidate;
use super::cause_sets::is_physically_possible;
use super::deviation_columns::DeviationColumns;
use super::evidence::Member;
use super::exploration::{Visibility, visibility};
use super::fit::Fit;
use super::linear_fit::LinearFit;
use super::progress::Reporter;
use super::search::{CandidateSet, EvaluatedSet, Search};
use super::{DiagnosisOptions, Stage};
use crate::estimation::EstimationError;

/// The best sets, and for variety the best set with `count` causes of each kind, smaller sets first. The kind is that of
/// the last cause: its effect, and whether it acts on one cable, on all alike or on each with its own value.
fn diverse_sets(
    candidates: &[Candidate],
    evaluated: &HashMap<CandidateSet, EvaluatedSet>,
    count: usize,
) -> Vec<Vec<Member>> {
    let mut sets: Vec<&EvaluatedSet> = evaluated.values().collect();
    sets.sort_by(|a, b| {
        let order = b.log_posterior.total_cmp(&a.log_posterior);
        order.then_with(|| a.members.cmp(&b.members))
    });
    let mut chosen: Vec<Vec<Member>> = sets
        .iter()
        .take(MAX_BEST_SETS)
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
    for evaluated in sets.iter().filter(|v| v.members.len() == count) {
        let set_kind = kind(&evaluated.members);
        if kinds.len() < MAX_KINDS && !kinds.contains(&set_kind) {
            kinds.push(set_kind);
            chosen.push(evaluated.members.clone());
        }
    }
    chosen.sort_by_key(Vec::len);
    chosen
}

/// Adds the causes that explain most of chi-square, in steps, as long as chi-square is far above its degrees of
/// freedom. The linear comparison is useless there, so one cause of each kind is fitted, with noise of the size of the
/// residuals. Larger sets are fitted only if no smaller one explains the readings.
pub(super) fn initial_fit<'a>(
    from: Fit<'a>,
    seen: &mut Option<Vec<Visibility>>,
    options: &DiagnosisOptions,
    report: &mut Reporter<'_, '_>,
) -> Result<Fit<'a>, EstimationError> {
    let problem = from.base().clone();
    // Next to such residuals, deviations within tolerances do not count.
    let no_deviations = Rc::new(DeviationColumns::none());
    let mut fit = from.with_deviation_columns(&no_deviations);
    for _ in 0..options.most_findings {
        let misfit = fit.chi2_per_freedom();
        if misfit < FAR_FROM_NOISE
            || !misfit.is_finite()
            || !report.stage(Stage::Refits, fit.causes.len())
        {
            break;
        }
        let linear_fit = LinearFit::new(&fit, true);
        let hyper = linear_fit.linear.with_variance_factor(misfit);
        let mut gram = linear_fit.gram(&hyper);
        seen.get_or_insert_with(|| visibility(&linear_fit.gram(&linear_fit.linear.described(0))));
        let candidates = &linear_fit.catalogue.candidates;
        let mut search = Search::new(&mut gram, options.most_findings);
        search.settle(&linear_fit.present);
        let findings = linear_fit.present.len();
        search.run(MAX_EXTENDED / 2, &mut || {
            report.stage(Stage::Scores, findings)
        });
        search.prune_from_all();
        let evaluated = search.evaluated;
        let price = (linear_fit.linear.conditions.count as f64).ln();
        // Log-likelihood with the noise scaled to the residuals, with the BIC penalty for parameters (Schwarz 1978) and
        // the prior of the set.
        let score = |fit: &Fit<'_>, members: &[Member]| {
            let freedom = fit.solution.degrees_of_freedom.max(1.0);
            let likelihood = freedom * (fit.solution.chi2 / freedom).max(1.0).ln();
            let odds: f64 = members.iter().map(|m| candidates[m.0].log_odds).sum();
            odds - 0.5 * (likelihood + price * fit.parameters() as f64)
        };
        let mut best: Option<(f64, Fit<'a>)> = None;
        for members in diverse_sets(candidates, &evaluated, findings + 1) {
            if same_members(&members, &linear_fit.present) || report.cancelled {
                continue;
            }
            let current = best.as_ref().map_or(&fit, |(_, better)| better);
            if current.causes.len() < members.len() && current.chi2_per_freedom() < FAR_FROM_NOISE {
                break;
            }
            let causes = linear_fit.causes_of(&mut gram, &members);
            let refit = if misfit < UNEXPLAINED_CHI2 {
                Fit::new(&problem, &causes)?
            } else {
                let bound = current.solution.chi2;
                Fit::with_early_stop((bound, PATIENCE_FAR_FROM_NOISE), &problem, &causes)?
            };
            let refit = refit.with_deviation_columns(&no_deviations);
            let value = score(&refit, &members);
            if is_physically_possible(&refit) && best.as_ref().is_none_or(|b| value > b.0) {
                best = Some((value, refit));
            }
        }
        let present_score = score(&fit, &linear_fit.present);
        match best {
            Some((value, better)) if value > present_score => fit = better,
            _ => break,
        }
    }
    Ok(fit)
}

fn same_members(one: &[Member], other: &[Member]) -> bool {
    one.len() == other.len() && one.iter().all(|m| other.iter().any(|o| o.0 == m.0))
}

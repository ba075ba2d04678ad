//! Exchanged channels: for every pair and kind of channel the exchange is undone, and an exchange is reported if it explains
//! the readings better than any effect could.
//!
//! Readings that a symmetry of the robot makes equal are no evidence: an exchange competes with the best fit of the readings as
//! they are, also with a fit that starts from interchanged pulleys, and needs the same odds as any other named cause.

use std::sync::Arc;

use super::Stage;
use super::budget::PATIENCE_WITH_EXCHANGE;
use super::calibration::{
    DISTINGUISHING_CHI2, HUGE_CHI2, MAX_REMAINING_EXCESS, NAMING_PROBABILITY, PART_OF_EXCESS,
};
use super::fit::Fit;
use super::gain::Prediction;
use super::priors::EXPECTED_CAUSES;
use super::progress::Reporter;
use super::report::{Alternative, Cause, Evidence, Finding, Rival, Subject};
use crate::effect::{BoundEffect, CATALOGUE, Search};
use crate::estimation::{EstimationError, Problem, Solution};
use crate::measurement::Dataset;

/// Exchanges that explain the readings together.
pub(super) struct Exchange {
    pub bounds: Vec<BoundEffect>,
    /// The measurements with the exchanges undone.
    pub dataset: Dataset,
    /// All exchanges that were tried in place of the last one, with their chi-square.
    tried: Vec<(BoundEffect, f64)>,
}

/// Assignment of channels to cables according to the readings.
pub(super) enum Channels {
    /// As described.
    AsDescribed,
    /// Exchanged between cables.
    Exchanged(Box<Exchange>),
    /// The pulleys of two cables are at each other's places, which explains the readings as well.
    PulleysExchanged(Box<Solution>),
}

/// Finds the exchange that explains the readings, if there is one, or several of different cables: another one is sought if the
/// best so far removes much, but not enough, of the excess chi-square.
pub(super) fn find_exchange(
    fit: &Fit<'_>,
    report: &mut Reporter<'_, '_>,
) -> Result<Channels, EstimationError> {
    let solution = &fit.solution;
    let is_exchange = |effect: &&&crate::effect::Effect| effect.search() == Search::Exchange;
    let Some(effect) = CATALOGUE.iter().find(is_exchange) else {
        return Ok(Channels::AsDescribed);
    };
    if solution.chi2 < HUGE_CHI2 * solution.degrees_of_freedom {
        return Ok(Channels::AsDescribed);
    }
    let mut dataset = fit.problem.dataset.clone();
    let allowed = solution.degrees_of_freedom
        + MAX_REMAINING_EXCESS * (solution.chi2 - solution.degrees_of_freedom);
    let kinds: &[f64] = match dataset.measurements.force_n.is_empty() {
        true => &[1.0],
        false => &[1.0, 2.0, 3.0],
    };
    let cables = dataset.robot.cable_count();
    let pairs: Vec<[usize; 2]> = (0..cables)
        .flat_map(|one| (one + 1..cables).map(move |other| [one, other]))
        .collect();
    let mut bounds: Vec<BoundEffect> = Vec::new();
    let mut questions = 0;
    let mut before = solution.chi2;
    let (tried, best) = loop {
        let is_free = |pair: &&[usize; 2]| {
            let mut taken = bounds.iter().flat_map(|bound| &bound.cables);
            taken.all(|cable| !pair.contains(cable))
        };
        let mut tried: Vec<(BoundEffect, f64)> = Vec::new();
        let mut best: Option<Solution> = None;
        for pair in pairs.iter().filter(is_free) {
            for kind in kinds {
                if !report.stage(Stage::Refits, 0) {
                    return Ok(Channels::AsDescribed);
                }
                let bound = BoundEffect {
                    effect,
                    cables: pair.to_vec(),
                    targeted: true,
                    values: vec![*kind],
                };
                let exchanged = undo_exchange(&dataset, &bound);
                let mut problem = Problem::new(&exchanged)?;
                problem.held_effects.clone_from(&fit.problem.held_effects);
                problem.free_effects.clone_from(&fit.problem.free_effects);
                let stop = (allowed, PATIENCE_WITH_EXCHANGE);
                let solution = Fit::with_early_stop(stop, &problem, &[])?.solution;
                tried.push((bound, solution.chi2));
                if (best.as_ref()).is_none_or(|best| solution.chi2 < best.chi2) {
                    best = Some(solution);
                }
            }
        }
        tried.sort_by(|a, b| a.1.total_cmp(&b.1));
        questions += tried.len();
        let Some(((bound, chi2), best)) = tried.first().cloned().zip(best) else {
            return Ok(Channels::AsDescribed);
        };
        if chi2 > before - PART_OF_EXCESS * (before - solution.degrees_of_freedom) {
            return Ok(Channels::AsDescribed);
        }
        dataset = undo_exchange(&dataset, &bound);
        bounds.push(bound);
        before = chi2;
        if chi2 < allowed {
            break (tried, best);
        }
    };
    let chi2 = best.chi2;
    let prior_odds = EXPECTED_CAUSES / (CATALOGUE.len() * questions) as f64;
    let named_odds = NAMING_PROBABILITY / (1.0 - NAMING_PROBABILITY);
    let needed = 2.0 * (named_odds / prior_odds).ln();
    if solution.chi2 - chi2 < needed {
        return Ok(Channels::AsDescribed);
    }
    let mirrored = with_pulleys_exchanged(fit, &bounds, best)?;
    if mirrored.solution.chi2 - chi2 < needed {
        return Ok(Channels::PulleysExchanged(Box::new(mirrored.solution)));
    }
    Ok(Channels::Exchanged(Box::new(Exchange {
        bounds,
        dataset,
        tried,
    })))
}

/// The fit of the readings as they are that starts at the solution for exchanged ones, with the pulleys of the cables of each
/// pair at each other's places.
fn with_pulleys_exchanged<'a>(
    fit: &Fit<'a>,
    bounds: &[BoundEffect],
    mut exchanged: Solution,
) -> Result<Fit<'a>, EstimationError> {
    for bound in bounds {
        let (one, other) = (bound.cables[0], bound.cables[1]);
        exchanged.globals.entry_points.swap(one, other);
        exchanged.globals.home_tension_error_n.swap(one, other);
    }
    let mut problem = fit.base().clone();
    problem.known = Some(Arc::new(exchanged));
    Fit::new(&problem, &[])
}

fn undo_exchange(dataset: &Dataset, bound: &BoundEffect) -> Dataset {
    let mut exchanged = dataset.clone();
    bound.exchange_channels(&mut exchanged.measurements);
    exchanged
}

impl Exchange {
    /// The findings; `first` and `second` are the fits before and after undoing the exchanges.
    pub fn findings(&self, first: &Fit<'_>, second: &Fit<'_>) -> Vec<Finding> {
        let robot = &self.dataset.robot;
        let (before, after) = (Prediction::new(first), Prediction::new(second));
        let best = first.solution.chi2 - second.solution.chi2;
        let rival = |(bound, chi2): &(BoundEffect, f64)| Rival {
            cause: cause(bound),
            delta_chi2: first.solution.chi2 - chi2,
            parameters: 0,
            holdout: f64::NAN,
        };
        let finding = |(index, bound): (usize, &BoundEffect)| {
            // The others were found beside fewer exchanges, so that theirs cannot be compared.
            let is_last = index + 1 == self.bounds.len();
            let shown = if is_last { 3 } else { 0 };
            let ranking: Vec<Rival> = self.tried.iter().take(shown).map(rival).collect();
            let behind = |rival: &Rival| ranking[0].delta_chi2 - rival.delta_chi2;
            let weight = |rival: &Rival| (-0.5 * behind(rival)).exp();
            let weights: f64 = ranking.iter().map(weight).sum();
            let others = ranking.iter().skip(1);
            let alternatives: Vec<Alternative> = others
                .filter(|rival| behind(rival) < DISTINGUISHING_CHI2)
                .map(|rival| Alternative {
                    subject: Subject::Cause(rival.cause.clone()),
                    probability: weight(rival) / weights,
                })
                .collect();
            Finding {
                subject: Subject::Cause(cause(bound)),
                probability: if is_last { weights.recip() } else { 1.0 },
                sentence: bound.cause(robot),
                advice: bound.workshop(robot),
                alternatives,
                parameters: Vec::new(),
                evidence: Evidence {
                    delta_chi2: best,
                    parameters: 0,
                    p_value: (self.tried.len() as f64 * (-best / 2.0).exp()).min(1.0),
                    questions: self.tried.len(),
                    ranking,
                },
                gain: after.gain_over(&before),
                separation: None,
            }
        };
        self.bounds.iter().enumerate().map(finding).collect()
    }
}

fn cause(bound: &BoundEffect) -> Cause {
    Cause {
        instances: vec![bound.clone()],
    }
}

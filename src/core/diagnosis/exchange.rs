//! Exchanged channels: for every pair and kind of channel the readings are exchanged back, and an exchange is reported
//! if it explains what no effect could.
//!
//! Readings that a symmetry of the robot makes equal are no evidence: an exchange competes with the best fit of the readings as
//! they are, also from pulleys that start at each other's places, and needs the odds of any other name.

use std::sync::Arc;

use super::Stage;
use super::budget::PATIENCE_WITH_EXCHANGE;
use super::calibration::{
    DISTINGUISHING_CHI2, HUGE_CHI2, MAX_REMAINING_EXCESS, NAMING_PROBABILITY,
};
use super::fit::Fit;
use super::gain::Prediction;
use super::priors::EXPECTED_CAUSES;
use super::progress::Reporter;
use super::report::{Alternative, Cause, Evidence, Finding, Rival, Subject};
use crate::effect::{BoundEffect, CATALOGUE, Search};
use crate::estimation::{EstimationError, Problem, Solution};
use crate::measurement::Dataset;

/// An exchange that explains the readings.
pub(super) struct Exchange {
    pub bound: BoundEffect,
    /// The measurements with the exchange undone.
    pub dataset: Dataset,
    /// All exchanges that were tried, with their chi-square.
    tried: Vec<(BoundEffect, f64)>,
}

/// What the readings say about the channels.
pub(super) enum Channels {
    /// They are as described.
    AsDescribed,
    /// Two are exchanged.
    Exchanged(Box<Exchange>),
    /// The pulleys of two cables are at each other's places, which explains the readings as well.
    PulleysExchanged(Box<Solution>),
}

/// Finds the exchange that explains the readings, if there is one.
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
    let dataset = fit.problem.dataset;
    let allowed = solution.degrees_of_freedom
        + MAX_REMAINING_EXCESS * (solution.chi2 - solution.degrees_of_freedom);
    let kinds: &[f64] = if dataset.measurements.force_n.is_empty() {
        &[1.0]
    } else {
        &[1.0, 2.0, 3.0]
    };
    let cables = dataset.robot.cable_count();
    let pairs = (0..cables).flat_map(|one| (one + 1..cables).map(move |k| (one, k)));
    let mut tried: Vec<(BoundEffect, f64)> = Vec::new();
    let mut best: Option<Solution> = None;
    for ((one, other), kind) in pairs.flat_map(|pair| kinds.iter().map(move |k| (pair, *k))) {
        if !report.stage(Stage::Refits, 0) {
            return Ok(Channels::AsDescribed);
        }
        let bound = BoundEffect {
            effect,
            cables: vec![one, other],
            targeted: true,
            values: vec![kind],
        };
        let exchanged = undo_exchange(dataset, &bound);
        let fit = {
            let mut problem = Problem::new(&exchanged)?;
            problem.held_effects.clone_from(&fit.problem.held_effects);
            problem.free_effects.clone_from(&fit.problem.free_effects);
            Fit::with_early_stop((allowed, PATIENCE_WITH_EXCHANGE), &problem, &[])?
        };
        tried.push((bound, fit.solution.chi2));
        if (best.as_ref()).is_none_or(|best| fit.solution.chi2 < best.chi2) {
            best = Some(fit.solution);
        }
    }
    tried.sort_by(|a, b| a.1.total_cmp(&b.1));
    let found = tried.first().filter(|(_, chi2)| *chi2 < allowed);
    let Some(((bound, chi2), best)) = found.zip(best) else {
        return Ok(Channels::AsDescribed);
    };
    let prior_odds = EXPECTED_CAUSES / (CATALOGUE.len() * tried.len()) as f64;
    let named_odds = NAMING_PROBABILITY / (1.0 - NAMING_PROBABILITY);
    let needed = 2.0 * (named_odds / prior_odds).ln();
    if solution.chi2 - chi2 < needed {
        return Ok(Channels::AsDescribed);
    }
    let mirrored = with_pulleys_exchanged(fit, bound, best)?;
    if mirrored.solution.chi2 - chi2 < needed {
        return Ok(Channels::PulleysExchanged(Box::new(mirrored.solution)));
    }
    Ok(Channels::Exchanged(Box::new(Exchange {
        bound: bound.clone(),
        dataset: undo_exchange(dataset, bound),
        tried: tried.clone(),
    })))
}

/// The fit of the readings as they are that starts at the solution for exchanged ones, with the pulleys of the two cables at
/// each other's places.
fn with_pulleys_exchanged<'a>(
    fit: &Fit<'a>,
    bound: &BoundEffect,
    mut exchanged: Solution,
) -> Result<Fit<'a>, EstimationError> {
    let (one, other) = (bound.cables[0], bound.cables[1]);
    exchanged.globals.entry_points.swap(one, other);
    exchanged.globals.home_tension_error_n.swap(one, other);
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
    /// The finding; `first` and `second` are the fits before and after undoing the exchange.
    pub fn finding(&self, first: &Fit<'_>, second: &Fit<'_>) -> Finding {
        let robot = &self.dataset.robot;
        let (before, after) = (Prediction::new(first), Prediction::new(second));
        let best = first.solution.chi2 - second.solution.chi2;
        let rival = |(bound, chi2): &(BoundEffect, f64)| Rival {
            cause: cause(bound),
            delta_chi2: first.solution.chi2 - chi2,
            parameters: 0,
            holdout: f64::NAN,
        };
        let ranking: Vec<Rival> = self.tried.iter().take(3).map(rival).collect();
        let weight = |rival: &Rival| (0.5 * (rival.delta_chi2 - ranking[0].delta_chi2)).exp();
        let weights: f64 = ranking.iter().map(weight).sum();
        let alternatives: Vec<Alternative> = ranking[1..]
            .iter()
            .filter(|rival| ranking[0].delta_chi2 - rival.delta_chi2 < DISTINGUISHING_CHI2)
            .map(|rival| Alternative {
                subject: Subject::Cause(rival.cause.clone()),
                probability: weight(rival) / weights,
            })
            .collect();
        Finding {
            subject: Subject::Cause(cause(&self.bound)),
            probability: weights.recip(),
            sentence: self.bound.cause(robot),
            advice: self.bound.workshop(robot),
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
    }
}

fn cause(bound: &BoundEffect) -> Cause {
    Cause {
        instances: vec![bound.clone()],
    }
}

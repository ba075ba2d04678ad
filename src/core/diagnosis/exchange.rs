//! Exchanged channels: for every pair and kind of channel the readings are exchanged back, and an exchange is reported
//! if it explains what no effect could.

use super::Stage;
use super::budget::PATIENCE_WITH_EXCHANGE;
use super::calibration::DISTINGUISHING_CHI2;
use super::calibration::{HUGE_CHI2, MAX_REMAINING_EXCESS};
use super::fit::Fit;
use super::gain::Prediction;
use super::progress::Reporter;
use super::report::{Alternative, Cause, Evidence, Finding, Rival, Subject};
use crate::effect::{BoundEffect, CATALOGUE, Search};
use crate::estimation::{EstimationError, Problem};
use crate::measurement::Dataset;

/// An exchange that explains the readings.
pub(super) struct Exchange {
    pub bound: BoundEffect,
    /// The measurements with the exchange undone.
    pub dataset: Dataset,
    /// All exchanges that were tried, with their chi-square.
    tried: Vec<(BoundEffect, f64)>,
}

/// Finds the exchange that explains the readings, if there is one.
pub(super) fn find_exchange(
    fit: &Fit<'_>,
    report: &mut Reporter<'_, '_>,
) -> Result<Option<Exchange>, EstimationError> {
    let solution = &fit.solution;
    let is_exchange = |effect: &&&crate::effect::Effect| effect.search() == Search::Exchange;
    let Some(effect) = CATALOGUE.iter().find(is_exchange) else {
        return Ok(None);
    };
    if solution.chi2 < HUGE_CHI2 * solution.degrees_of_freedom {
        return Ok(None);
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
    let mut tried = Vec::new();
    for ((one, other), kind) in pairs.flat_map(|pair| kinds.iter().map(move |k| (pair, *k))) {
        if !report.stage(Stage::Refits, 0) {
            return Ok(None);
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
    }
    tried.sort_by(|a, b| a.1.total_cmp(&b.1));
    let found = tried.first().filter(|(_, chi2)| *chi2 < allowed);
    Ok(found.map(|(bound, _)| Exchange {
        bound: bound.clone(),
        dataset: undo_exchange(dataset, bound),
        tried: tried.clone(),
    }))
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

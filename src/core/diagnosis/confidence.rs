//! Decides which inferred causes are confirmed and with which probability they are stated.

use super::DiagnosisOptions;
use super::adequacy::adequacy;
use super::calibration::{
    ERROR_SHARE, EXCESS_SHARE, IMITATION_RATE, LIKELY, LOOKS_THE_SAME, MAX_IMITATION_RATE,
    NAMING_PROBABILITY, NONE_PRESENT_RATE, READINGS_SHARE,
};
use super::candidates::{log_rarity, size_parameter};
use super::cause_posteriors::CausePosterior;
use super::cause_sets::{has_possible_values, is_physically_possible, is_same_cause};
use super::discrepancy::{dependence_tests, discrepancies};
use super::fit::Fit;
use super::gain::Prediction;
use super::heavy_tails::shares_of_heavy_tails;
use super::inference::{Inference, inference_at_fit};
use super::reading_id::ReadingId;
use super::report::{
    Adequacy, Alternative, Cause, Discrepancy, Finding, FoundParameter, NoiseStatement,
    PossibleCause, Subject, Verdict,
};
use super::residual_space::ResidualSpace;
use super::unmodelled_errors::{UnmodelledErrors, WeighedError};
use super::variables::Variables;
use crate::effect::Search;
use crate::estimation::{EstimationError, Problem};

/// Confirmed causes with their posteriors, and other possible causes.
pub(super) struct ConfirmedCauses<'a> {
    pub inference: Inference<'a>,
    pub posteriors: Vec<CausePosterior>,
    pub possible: Vec<PossibleCause>,
    /// Likely causes that are not confirmed.
    likely: Vec<(Cause, CausePosterior)>,
}

/// Rejects causes that an unmodelled error almost certainly replaces, refitting until none is left.
pub(super) fn reject_replaceable_causes<'a>(
    problem: &Problem<'a>,
    confirmed: ConfirmedCauses<'a>,
) -> Result<(ConfirmedCauses<'a>, UnmodelledErrors), EstimationError> {
    let ConfirmedCauses {
        mut inference,
        mut posteriors,
        mut possible,
        likely,
    } = confirmed;
    let mut replacements: Vec<WeighedError> = Vec::new();
    loop {
        let mut unmodelled = UnmodelledErrors::new(&inference);
        let mut causes = Vec::new();
        let mut accepted = Vec::new();
        let all = inference.fit.causes.iter().zip(posteriors);
        for ((cause, posterior), rival) in all.zip(&unmodelled.rivals) {
            match rival
                .as_ref()
                .filter(|rival| rival.probability() >= NAMING_PROBABILITY)
            {
                Some(rival) => {
                    possible.push(PossibleCause {
                        cause: cause.clone(),
                        probability: posterior.probability * (1.0 - rival.probability()),
                    });
                    replacements.push(rival.clone());
                }
                None => {
                    causes.push(cause.clone());
                    accepted.push(posterior);
                }
            }
        }
        posteriors = accepted;
        if causes.len() == inference.fit.causes.len() {
            for rival in replacements {
                if unmodelled
                    .remaining
                    .iter()
                    .all(|known| known.error.readings != rival.error.readings)
                {
                    unmodelled.remaining.push(rival);
                }
            }
            let confirmed = ConfirmedCauses {
                inference,
                posteriors,
                possible,
                likely,
            };
            return Ok((confirmed, unmodelled));
        }
        let fit = fit_of_possible(problem, causes, &mut posteriors)?;
        let fit = fit.with_deviation_columns(&inference.fit.deviation_columns());
        inference = inference_at_fit(fit, Vec::new(), Some(&inference.hyper.variance));
    }
}

/// Fits some of the causes of another fit without the rest, and without those whose values are then physically impossible.
fn fit_of_possible<'a>(
    problem: &Problem<'a>,
    mut causes: Vec<Cause>,
    posteriors: &mut Vec<CausePosterior>,
) -> Result<Fit<'a>, EstimationError> {
    loop {
        let fit = Fit::new(problem, &causes)?;
        let impossible = fit.causes.iter().position(|c| !has_possible_values(c));
        let Some(impossible) = impossible else {
            return Ok(fit);
        };
        causes.remove(impossible);
        posteriors.remove(impossible);
    }
}

/// Adds likely causes back if they explain an unmodelled error. The finding is then ambiguous between the two.
pub(super) fn readmit_likely_causes<'a>(
    problem: &Problem<'a>,
    (mut confirmed, mut unmodelled): (ConfirmedCauses<'a>, UnmodelledErrors),
    options: &DiagnosisOptions,
) -> Result<(ConfirmedCauses<'a>, UnmodelledErrors), EstimationError> {
    let errors = |inference: &Inference<'_>, unmodelled: &UnmodelledErrors| {
        if unmodelled.remaining.is_empty() {
            let (_, found, _) = assess_fit(&inference.fit, options.alpha);
            found
                .iter()
                .take(1)
                .map(WeighedError::from_discrepancy)
                .collect()
        } else {
            unmodelled.remaining.clone()
        }
    };
    for (cause, posterior) in std::mem::take(&mut confirmed.likely) {
        let before = errors(&confirmed.inference, &unmodelled);
        let Some(mut instead) = before.first().cloned() else {
            break;
        };
        let mut causes = confirmed.inference.fit.causes.clone();
        causes.push(cause);
        let fit = Fit::new(problem, &causes)?;
        if !is_physically_possible(&fit) {
            continue;
        }
        let columns = confirmed.inference.fit.deviation_columns();
        let fit = fit.with_deviation_columns(&columns);
        let with = inference_at_fit(fit, Vec::new(), Some(&confirmed.inference.hyper.variance));
        let mut remaining = UnmodelledErrors::new(&with);
        if errors(&with, &remaining).len() >= before.len() {
            continue;
        }
        let is_other = |a: &PossibleCause| !is_same_cause(&a.cause, &causes[causes.len() - 1]);
        confirmed.possible.retain(is_other);
        // One of the two is present, so the odds follow from the known probability of the cause.
        instead.log_odds = (posterior.probability.recip() - 1.0).ln();
        if let Some(rival) = remaining.rivals.last_mut() {
            *rival = Some(instead);
        }
        confirmed.posteriors.push(CausePosterior {
            probability: 1.0,
            alternatives: Vec::new(),
            is_near_certain: true,
        });
        confirmed.inference = with;
        unmodelled = remaining;
    }
    Ok((confirmed, unmodelled))
}

/// Confirms the causes that are nearly certain and improve the prediction of held-out poses, and refits the model with
/// those alone. The others become possible causes.
pub(super) fn confirm_causes<'a>(
    problem: &Problem<'a>,
    inference: Inference<'a>,
    posteriors: Vec<CausePosterior>,
    mut possible: Vec<PossibleCause>,
) -> Result<ConfirmedCauses<'a>, EstimationError> {
    let full = Prediction::new(&inference.fit);
    let mut confirmed: Vec<(f64, Cause, CausePosterior)> = Vec::new();
    let mut likely = Vec::new();
    for (index, (cause, posterior)) in inference.fit.causes.iter().zip(posteriors).enumerate() {
        let mut others = inference.fit.causes.clone();
        others.remove(index);
        let without = Fit::new(problem, &others)?;
        // The other poses cannot predict an event at a single pose.
        let is_event = matches!(cause.effect().search(), Search::AtPose(_));
        if posterior.is_near_certain
            && (is_event || full.is_better_than(&Prediction::new(&without)))
        {
            confirmed.push((without.solution.chi2, cause.clone(), posterior));
            continue;
        }
        possible.push(PossibleCause {
            cause: cause.clone(),
            probability: posterior.probability,
        });
        possible.extend(posterior.alternatives.iter().cloned());
        if (LIKELY..NAMING_PROBABILITY).contains(&posterior.probability) {
            likely.push((cause.clone(), posterior));
        }
    }
    possible.sort_by(|a, b| b.probability.total_cmp(&a.probability));
    let is_complete = confirmed.len() == inference.fit.causes.len();
    let is_ordered = confirmed.windows(2).all(|pair| pair[0].0 >= pair[1].0);
    // The cause that explains most comes first.
    confirmed.sort_by(|a, b| b.0.total_cmp(&a.0));
    let (causes, mut posteriors): (Vec<_>, Vec<_>) = confirmed
        .into_iter()
        .map(|(_, cause, posterior)| (cause, posterior))
        .unzip();
    let inference = if is_complete && is_ordered {
        inference
    } else {
        let fit = fit_of_possible(problem, causes, &mut posteriors)?;
        let fit = fit.with_deviation_columns(&inference.fit.deviation_columns());
        inference_at_fit(fit, Vec::new(), Some(&inference.hyper.variance))
    };
    Ok(ConfirmedCauses {
        inference,
        posteriors,
        possible,
        likely,
    })
}

/// Downgrades names that an unmodelled error might explain as well.
pub(super) fn downgrade_doubtful_names(
    findings: &mut [Finding],
    inference: &Inference<'_>,
    (rivals, remaining): (&[Option<WeighedError>], &[WeighedError]),
    (scatter, space): (&[(ReadingId, f64)], &ResidualSpace),
) {
    // An improbable rival does not make a near-certain name ambiguous.
    let matters = |share: f64| 1.0 - share < NAMING_PROBABILITY;
    // Exchanged channels come first in the findings and have no rivals.
    let first = findings.len() - rivals.len();
    let tails = shares_of_heavy_tails(findings, first, inference, space);
    for (index, (finding, tails)) in findings.iter_mut().zip(tails).enumerate() {
        let own = finding.subject.cables();
        let own_index = index.checked_sub(first);
        let rival = own_index.and_then(|k| rivals[k].as_ref());
        let rival = rival.map(|r| (r.clone(), r.probability()));
        let rival = rival.filter(|(_, share)| matters(*share));
        let explained = finding.evidence.delta_chi2;
        let of_own = |id: &ReadingId| id.cable.is_none_or(|cable| own.contains(&cable));
        let mut scatter = scatter.iter();
        let scattered =
            scatter.find(|(id, excess)| of_own(id) && *excess > EXCESS_SHARE * explained);
        let beside = remaining.iter().find(|error| {
            let same = error
                .error
                .readings
                .cable
                .is_some_and(|cable| own.contains(&cable));
            let shares = || {
                own_index.is_some_and(|k| {
                    inference.share_of_effect_in(k, &error.error.readings) > READINGS_SHARE
                })
            };
            2.0 * error.log_odds > ERROR_SHARE * explained && (same || shares())
        });
        // It is undecided which of them explains what they share.
        let open = scattered.map(|(id, _)| WeighedError::of(*id));
        let open = open.or_else(|| beside.cloned()).map(|other| (other, 0.5));
        // A size beyond that of real machines suggests another error that looks the same.
        let odds = (log_rarity_of(finding) - LOOKS_THE_SAME).exp();
        let share = tails.max(odds / (1.0 + odds));
        let imitated = || {
            let id = inference.most_affected_class(own_index.filter(|_| matters(share))?)?;
            Some((WeighedError::of(id), share))
        };
        let Some((other, share)) = rival.or(open).or_else(imitated) else {
            continue;
        };
        finding.verdict = Verdict::Ambiguous;
        finding.alternatives.truncate(1);
        finding.alternatives.push(Alternative {
            subject: Subject::UnmodelledError(other.error),
            probability: finding.probability * share,
        });
        finding.probability *= 1.0 - share;
    }
}

/// Allows for errors outside the catalogue, which the evidence ignores, by lowering the probabilities of all findings.
/// A name that falls below the naming threshold is no longer certain.
pub(super) fn allow_for_imitations(findings: &mut [Finding]) {
    for finding in findings {
        if finding.verdict == Verdict::Named {
            finding.probability *= 1.0 - imitation_rate(finding.evidence.delta_chi2);
            finding.alternatives.clear();
            if finding.probability < NAMING_PROBABILITY {
                finding.verdict = Verdict::Ambiguous;
            }
            continue;
        }
        finding.probability *= 1.0 - NONE_PRESENT_RATE;
        for alternative in &mut finding.alternatives {
            alternative.probability *= 1.0 - NONE_PRESENT_RATE;
        }
    }
}

/// Share of names that are imitations by errors outside the catalogue, for causes that explain a given chi-square.
///
/// An error outside the catalogue can pass for a cause if noise hides the difference of their shapes. If that
/// difference is equally likely to be any fraction of what the cause explains, the share that noise hides is
/// proportional to `1 / sqrt(chi-square explained)`.
fn imitation_rate(explained: f64) -> f64 {
    (IMITATION_RATE / explained.max(1.0).sqrt()).min(MAX_IMITATION_RATE)
}

/// Log prior rarity of the size of a cause, relative to the largest typical size, at the lower end of its confidence
/// interval.
fn log_rarity_of(finding: &Finding) -> f64 {
    let Some(effect) = finding.cause().map(Cause::effect) else {
        return 0.0;
    };
    let Some(size) = size_parameter(effect) else {
        return 0.0;
    };
    // The typical size of a vector bounds each of its coordinates, so their squares are summed.
    let of_instance = |found: &[FoundParameter]| {
        let alike = effect.parameters().iter().zip(found);
        let alike = alike.filter(|(p, _)| p.unit == size.unit && !p.discrete);
        let squares = alike.map(|(p, found)| {
            let certain = (found.value - p.neutral).abs() - 2.0 * found.sd.unwrap_or(0.0);
            let [_, largest] = p.typical_sizes();
            (certain.max(0.0) / largest).powi(2)
        });
        squares.sum::<f64>().sqrt()
    };
    let instances = finding.parameters.chunks(effect.parameters().len());
    log_rarity(size, instances.map(of_instance).fold(0.0, f64::max))
}

/// Excess chi-square, beyond that of noise, of readings whose residuals depend on a variable and of cables whose
/// readings scatter more than those of the others.
pub(super) fn excess_chi2(
    space: &ResidualSpace,
    remaining: &[Discrepancy],
    noise: &[NoiseStatement],
) -> Vec<(ReadingId, f64)> {
    let structured = remaining.iter().map(|d| {
        let excess = d.points.len() as f64 * (d.rms_over_sd.powi(2) - 1.0);
        (WeighedError::from_discrepancy(d).error.readings, excess)
    });
    let loud = noise.iter().filter(|statement| statement.cable.is_some());
    let loud = loud.map(|statement| {
        let id = ReadingId {
            quantity: statement.quantity,
            cable: statement.cable,
            component: None,
        };
        let readings = space.readings.iter().filter(|r| **r == Some(id)).count();
        (id, readings as f64 * (statement.ratio.powi(2) - 1.0))
    });
    structured.chain(loud).collect()
}

/// Tests whether a fit explains the data and on which variables its residuals depend.
pub(super) fn assess_fit(fit: &Fit<'_>, alpha: f64) -> (Adequacy, Vec<Discrepancy>, ResidualSpace) {
    // Half of the level is for the test of the whole fit, half for the dependences of its residuals.
    let level = alpha / 2.0;
    let linear = fit.linearisation();
    let space = ResidualSpace::new(&linear);
    let variables = Variables::new(&fit.problem, &fit.solution, &linear);
    let tests = dependence_tests(&space, &variables);
    let found = discrepancies(&space, &tests, level);
    (adequacy(&space, &fit.solution, level), found, space)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn causes_that_explain_more_are_imitated_less() {
        let expected = [(2500.0, 0.01), (100.0, 0.02), (10.0, 0.02), (0.0, 0.02)];
        for (explained, rate) in expected {
            assert!((imitation_rate(explained) - rate).abs() < 1e-12);
        }
    }
}

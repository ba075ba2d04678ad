//! Decides which inferred causes are confirmed and with which probability they are stated.

use super::adequacy::adequacy;
use super::candidates::{log_rarity, size_parameter};
use super::claims::{Claim, MOST_IMITATED, SURE};
use super::discrepancy::{dependence_tests, discrepancies};
use super::fit::Fit;
use super::gain::Prediction;
use super::inference::{Inference, at_fit, is_same_cause};
use super::reading_id::ReadingId;
use super::remainder::{Nameless, Remainder};
use super::report::{
    Adequacy, Alternative, Cause, Discrepancy, Finding, FoundParameter, NoiseStatement, Verdict,
};
use super::residual_space::ResidualSpace;
use super::variables::Variables;
use super::{DiagnosisOptions, Quantity};
use crate::effect::Search;
use crate::estimation::{EstimationError, Linearisation, Problem};

/// Probability from which an unconfirmed cause counts as likely.
const LIKELY: f64 = 0.5;
/// A name becomes ambiguous if readings of its cables have excess scatter of more than this share of what the cause
/// explains.
const LEFT: f64 = 0.25;
/// A remaining unmodelled error makes a name ambiguous if it explains more than `PART` of what the cause explains and
/// either is on the same cable or is in readings that have more than `SHARE` of the effect of the cause.
const PART: f64 = 0.05;
const SHARE: f64 = 0.2;
/// Log odds for a cause against an error outside the catalogue that looks exactly like it.
const LOOKS_THE_SAME: f64 = 4.5;
/// Probability that an error outside the catalogue imitates a cause that explains a chi-square of 1, which falls with
/// the square root of the chi-square explained, and probability that none of the causes of a list is present. Both were
/// counted on simulated development data, some with a slightly wrong model or an effect outside the catalogue.
const IMITATED: f64 = 0.5;
const NONE_OF_THEM: f64 = 0.2;
/// From this number on, events on one reading look like a pattern, unless each has at least the chi-square gain
/// `LARGE_EVENT`.
const MANY_EVENTS: usize = 2;
const LARGE_EVENT: f64 = 60.0;

/// Confirmed causes with their posteriors, and other possible causes.
pub(super) struct Kept<'a> {
    pub inference: Inference<'a>,
    pub claims: Vec<Claim>,
    pub possible: Vec<Alternative>,
    /// Likely causes that are not confirmed.
    likely: Vec<(Cause, Claim)>,
}

/// Rejects causes that an unmodelled error almost certainly replaces, refitting until none is left.
pub(super) fn contested<'a>(
    problem: &Problem<'a>,
    kept: Kept<'a>,
    options: &DiagnosisOptions,
) -> Result<(Kept<'a>, Remainder), EstimationError> {
    let Kept {
        mut inference,
        mut claims,
        mut possible,
        likely,
    } = kept;
    let mut lost: Vec<Nameless> = Vec::new();
    loop {
        let mut remainder = Remainder::new(&inference);
        let mut causes = Vec::new();
        let mut kept = Vec::new();
        let all = inference.fit.causes.iter().zip(claims);
        for ((cause, claim), rival) in all.zip(&remainder.rivals) {
            match rival.as_ref().filter(|rival| rival.probability() >= SURE) {
                Some(rival) => {
                    possible.push(Alternative {
                        cause: cause.clone(),
                        probability: claim.probability * (1.0 - rival.probability()),
                    });
                    lost.push(rival.clone());
                }
                None => {
                    causes.push(cause.clone());
                    kept.push(claim);
                }
            }
        }
        claims = kept;
        if causes.len() == inference.fit.causes.len() {
            for rival in lost {
                if remainder.left.iter().all(|known| known.id != rival.id) {
                    remainder.left.push(rival);
                }
            }
            let kept = Kept {
                inference,
                claims,
                possible,
                likely,
            };
            return Ok((kept, remainder));
        }
        let fit = Fit::new(problem, &causes)?;
        inference = at_fit(fit, options, Vec::new(), &inference.linear.start);
    }
}

/// Adds likely causes back if they explain an unmodelled error. The finding is then ambiguous between the two.
pub(super) fn weighed<'a>(
    problem: &Problem<'a>,
    (mut kept, mut remainder): (Kept<'a>, Remainder),
    options: &DiagnosisOptions,
) -> Result<(Kept<'a>, Remainder), EstimationError> {
    let errors = |inference: &Inference<'_>, remainder: &Remainder| {
        if remainder.left.is_empty() {
            let (_, found, _) = judged(&inference.fit, options.alpha);
            found.iter().take(1).map(Nameless::of_discrepancy).collect()
        } else {
            remainder.left.clone()
        }
    };
    for (cause, claim) in std::mem::take(&mut kept.likely) {
        let before = errors(&kept.inference, &remainder);
        let Some(mut instead) = before.first().cloned() else {
            break;
        };
        let mut causes = kept.inference.fit.causes.clone();
        causes.push(cause);
        let fit = Fit::new(problem, &causes)?;
        let with = at_fit(fit, options, Vec::new(), &kept.inference.linear.start);
        let mut left = Remainder::new(&with);
        if errors(&with, &left).len() >= before.len() {
            continue;
        }
        let is_other = |a: &Alternative| !is_same_cause(&a.cause, &causes[causes.len() - 1]);
        kept.possible.retain(is_other);
        // One of the two is present, so the odds follow from the known probability of the cause.
        instead.log_odds = (claim.probability.recip() - 1.0).ln();
        if let Some(rival) = left.rivals.last_mut() {
            *rival = Some(instead);
        }
        kept.claims.push(Claim {
            probability: 1.0,
            alternatives: Vec::new(),
            is_sure: true,
        });
        kept.inference = with;
        remainder = left;
    }
    Ok((kept, remainder))
}

/// Confirms the causes that are nearly certain and improve the prediction of held-out poses, and refits the model with
/// those alone. The others become possible causes.
pub(super) fn kept<'a>(
    problem: &Problem<'a>,
    inference: Inference<'a>,
    claims: Vec<Claim>,
    mut possible: Vec<Alternative>,
    options: &DiagnosisOptions,
) -> Result<Kept<'a>, EstimationError> {
    let full = Prediction::new(&inference.fit);
    let mut kept: Vec<(f64, Cause, Claim)> = Vec::new();
    let mut likely = Vec::new();
    for (index, (cause, claim)) in inference.fit.causes.iter().zip(claims).enumerate() {
        let mut others = inference.fit.causes.clone();
        others.remove(index);
        let without = Fit::new(problem, &others)?;
        // The other poses cannot predict an event at a single pose.
        let is_event = matches!(cause.effect().search(), Search::AtPose(_));
        if claim.is_sure && (is_event || full.is_better_than(&Prediction::new(&without))) {
            kept.push((without.solution.chi2, cause.clone(), claim));
            continue;
        }
        possible.push(Alternative {
            cause: cause.clone(),
            probability: claim.probability,
        });
        possible.extend(claim.alternatives.iter().cloned());
        if (LIKELY..SURE).contains(&claim.probability) {
            likely.push((cause.clone(), claim));
        }
    }
    possible.sort_by(|a, b| b.probability.total_cmp(&a.probability));
    let is_complete = kept.len() == inference.fit.causes.len();
    let is_ordered = kept.windows(2).all(|pair| pair[0].0 >= pair[1].0);
    // The cause that explains most comes first.
    kept.sort_by(|a, b| b.0.total_cmp(&a.0));
    let (causes, claims): (Vec<_>, Vec<_>) = kept
        .into_iter()
        .map(|(_, cause, claim)| (cause, claim))
        .unzip();
    let inference = if is_complete && is_ordered {
        inference
    } else {
        let fit = Fit::new(problem, &causes)?;
        at_fit(fit, options, Vec::new(), &inference.linear.start)
    };
    Ok(Kept {
        inference,
        claims,
        possible,
        likely,
    })
}

/// Downgrades names that an unmodelled error might explain as well.
pub(super) fn temper(
    findings: &mut [Finding],
    inference: &Inference<'_>,
    (rivals, left): (&[Option<Nameless>], &[Nameless]),
    scatter: &[(ReadingId, f64)],
) {
    let cables = inference.fit.problem.dataset.robot.cable_count();
    let many = |finding: &Finding, all: &[Finding]| {
        let small = |f: &&Finding| {
            let at_pose = matches!(f.cause.effect().search(), Search::AtPose(_));
            at_pose
                && f.evidence.delta_chi2 < LARGE_EVENT
                && f.cause.cables() == finding.cause.cables()
        };
        small(&finding) && all.iter().filter(small).count() >= MANY_EVENTS
    };
    let events: Vec<bool> = findings.iter().map(|f| many(f, findings)).collect();
    // An improbable rival does not make a near-certain name ambiguous.
    let matters = |share: f64| 1.0 - share < SURE;
    // Exchanged channels come first in the findings and have no rivals.
    let first = findings.len() - rivals.len();
    for (index, (finding, is_event)) in findings.iter_mut().zip(events).enumerate() {
        let own = finding.cause.cables();
        let own_index = index.checked_sub(first);
        let rival = own_index.and_then(|k| rivals[k].as_ref());
        let rival = rival.map(|r| (r.clone(), r.probability()));
        let rival = rival.filter(|(_, share)| matters(*share));
        let explained = finding.evidence.delta_chi2;
        let of_own = |id: &ReadingId| id.cable.is_none_or(|cable| own.contains(&cable));
        let mut scatter = scatter.iter();
        let scattered = scatter.find(|(id, excess)| of_own(id) && *excess > LEFT * explained);
        let beside = left.iter().find(|error| {
            let same = error.id.cable.is_some_and(|cable| own.contains(&cable));
            let shares = || own_index.is_some_and(|k| inference.share_in(k, &error.id) > SHARE);
            2.0 * error.log_odds > PART * explained && (same || shares())
        });
        // It is undecided which of them explains what they share.
        let open = scattered.map(|(id, _)| Nameless::of(*id));
        let open = open.or_else(|| beside.cloned()).or_else(|| {
            is_event.then(|| {
                Nameless::of(ReadingId {
                    quantity: Quantity::Length,
                    cable: own.first().copied(),
                    component: None,
                })
            })
        });
        // A size beyond that of real machines suggests another error that looks the same.
        let odds = (log_rarity_of(finding) - LOOKS_THE_SAME).exp();
        let share = odds / (1.0 + odds);
        let odd = || {
            let id = inference.most_changed(own_index.filter(|_| matters(share))?)?;
            Some((Nameless::of(id), share))
        };
        let Some((other, share)) = rival.or(open.map(|other| (other, 0.5))).or_else(odd) else {
            continue;
        };
        finding.verdict = Verdict::Ambiguous;
        finding.alternatives.truncate(1);
        finding.alternatives.push(Alternative {
            cause: other.cause(cables),
            probability: finding.probability * share,
        });
        finding.probability *= 1.0 - share;
    }
}

/// Allows for errors outside the catalogue, which the evidence ignores, by lowering the probabilities of all findings.
/// A name that falls below the naming threshold becomes a list.
pub(super) fn allow_for_imitations(findings: &mut [Finding]) {
    for finding in findings {
        if finding.verdict == Verdict::Named {
            let explained = finding.evidence.delta_chi2;
            if let Some(probability) = probability_of_name(finding.probability, explained) {
                finding.probability = probability;
                finding.alternatives.clear();
                continue;
            }
            finding.verdict = Verdict::Ambiguous;
        }
        finding.probability *= 1.0 - NONE_OF_THEM;
        for alternative in &mut finding.alternatives {
            alternative.probability *= 1.0 - NONE_OF_THEM;
        }
    }
}

/// Probability of a named cause that explains a given chi-square; `None` if it is too low for a name.
///
/// An error outside the catalogue can pass for a cause if noise hides the difference of their shapes. If that
/// difference is equally likely to be any fraction of what the cause explains, the share that noise hides is
/// proportional to `1 / sqrt(chi-square explained)`.
fn probability_of_name(probability: f64, explained: f64) -> Option<f64> {
    let imitated = (IMITATED / explained.max(1.0).sqrt()).min(MOST_IMITATED);
    let stated = probability * (1.0 - imitated);
    (stated >= SURE).then_some(stated)
}

/// Log prior rarity of the size of a cause, relative to the largest typical size, at the lower end of its confidence
/// interval.
fn log_rarity_of(finding: &Finding) -> f64 {
    let effect = finding.cause.effect();
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
pub(super) fn excess(
    space: &ResidualSpace,
    remaining: &[Discrepancy],
    noise: &[NoiseStatement],
) -> Vec<(ReadingId, f64)> {
    let structured = remaining.iter().map(|d| {
        let excess = d.points.len() as f64 * (d.rms_over_sd.powi(2) - 1.0);
        (Nameless::of_discrepancy(d).id, excess)
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
pub(super) fn judged(fit: &Fit<'_>, alpha: f64) -> (Adequacy, Vec<Discrepancy>, ResidualSpace) {
    // Half of the false alarm probability is allotted to the tests of the residuals, half to the causes.
    let level = alpha / 2.0;
    let linear = Linearisation::new(&fit.problem, &fit.solution);
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
    fn the_more_a_cause_explains_the_surer_is_its_name() {
        let stated = |p, explained| probability_of_name(p, explained);
        let expected = [(2500.0, 0.99), (100.0, 0.97), (10.0, 0.97), (0.0, 0.97)];
        for (explained, probability) in expected {
            assert!((stated(1.0, explained).unwrap() - probability).abs() < 1e-12);
        }
        assert!(stated(0.96, 1e6).is_some());
        assert_eq!(stated(0.96, 100.0), None);
    }
}

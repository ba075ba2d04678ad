//! How sure a name is: what else would explain the data as well in its place.

use nalgebra::DMatrix;

use super::DiagnosisOptions;
use super::fit::Fit;
use super::gain::Prediction;
use super::report::{Alternative, Cause, Evidence, Finding, FoundParameter, Gain, Rival, Verdict};
use super::selection::{CLEAR, Contender, PREFERRED, Round, Selection, is_alike, is_extension};
use super::separation::separation;
use super::space::cosine;
use crate::estimation::{Linearisation, ParameterId};
use crate::robot::Robot;

/// Most causes that a finding lists besides its own.
const ALTERNATIVES: usize = 2;
/// Most contenders of which everything is reported.
const RANKED: usize = 6;

/// The finding of one cause of a selection; none if the diagnosis was cancelled before it was compared.
pub(super) fn finding(
    selection: &Selection<'_>,
    index: usize,
    gain: Gain,
    options: &DiagnosisOptions,
) -> Option<Finding> {
    let round = selection.rounds.get(index)?;
    let cause = &selection.fit.causes[index];
    let own = round.of(cause).or(round.contenders.first())?;
    let rivals = rivals(round, own, options);
    let robot = &selection.fit.problem.dataset.robot;
    let verdict = match (own.is_unknown(), rivals.is_empty()) {
        (true, true) => Verdict::Unknown,
        (false, true) => Verdict::Named,
        (_, false) => Verdict::Ambiguous,
    };
    let weights: f64 = round.contenders.iter().map(|c| weight(own, c)).sum();
    let probability = |c: &Contender<'_>| weight(own, c) / weights;
    let separation = rivals
        .first()
        .and_then(|rival| separation(&own.fit, &rival.fit));
    Some(Finding {
        verdict,
        sentence: joined(cause, robot, crate::effect::BoundEffect::cause),
        advice: joined(cause, robot, crate::effect::BoundEffect::workshop),
        probability: probability(own),
        alternatives: rivals
            .iter()
            .map(|rival| Alternative {
                cause: rival.cause().clone(),
                probability: probability(rival),
            })
            .collect(),
        parameters: parameters(&selection.fit, index),
        evidence: Evidence {
            delta_chi2: own.gain,
            parameters: own.fit.parameters_of(own.fit.causes.len() - 1).len(),
            p_value: round.corrected(own),
            questions: round.questions.iter().sum(),
            ranking: ranking(round, own),
        },
        gain,
        separation,
        cause: cause.clone(),
    })
}

/// Evidence of a contender over that of `own`.
fn weight(own: &Contender<'_>, contender: &Contender<'_>) -> f64 {
    (0.5 * (contender.score() - own.score())).exp()
}

/// The sentences of all instances, each once.
fn joined(
    cause: &Cause,
    robot: &Robot,
    text: impl Fn(&crate::effect::BoundEffect, &Robot) -> String,
) -> String {
    let mut sentences: Vec<String> = Vec::new();
    for bound in &cause.instances {
        let sentence = text(bound, robot);
        if !sentences.contains(&sentence) {
            sentences.push(sentence);
        }
    }
    sentences.join(" ")
}

/// Causes that explain the data as well, the best first.
fn rivals<'r, 'a>(
    round: &'r Round<'a>,
    own: &Contender<'a>,
    options: &DiagnosisOptions,
) -> Vec<&'r Contender<'a>> {
    let mut found: Vec<&Contender<'a>> = Vec::new();
    for contender in &round.contenders {
        // A smooth function can imitate every cause: it stands beside a name only if it fits better.
        let beside_name = contender.is_unknown() && !own.is_unknown();
        let least = if beside_name { -PREFERRED } else { CLEAR };
        let near = distance(own, contender) < least;
        // Structure without a name is the same on whatever variable.
        let known = |other: &Contender<'_>| {
            is_alike(contender.cause(), other.cause())
                || contender.is_unknown() && other.is_unknown()
                || is_extension(contender.cause(), other.cause())
        };
        let is_new = !known(own) && !found.iter().any(|other| known(other));
        if near && is_new && round.is_significant(contender, options.alpha) {
            found.push(contender);
        }
    }
    found.truncate(ALTERNATIVES);
    found
}

/// By how much a contender explains the data worse: in chi-square, two allowed for every parameter (Akaike 1974), so
/// that a simple cause does not hide a richer one that fits better. Structure without a name, whose
/// freedom is not a number of parameters, is compared by its evidence.
fn distance(own: &Contender<'_>, other: &Contender<'_>) -> f64 {
    if own.is_unknown() || other.is_unknown() {
        return own.score() - other.score();
    }
    let worth = |c: &Contender<'_>| c.gain - 2.0 * c.scored.visible as f64 - c.scored.places;
    worth(own) - worth(other)
}

/// The cause itself, then all others in their order.
fn ranking(round: &Round<'_>, own: &Contender<'_>) -> Vec<Rival> {
    let signature = signature(round, own);
    let others = round
        .contenders
        .iter()
        .filter(|c| !is_alike(c.cause(), own.cause()));
    let all = std::iter::once(own).chain(others).take(RANKED);
    all.map(|contender| Rival {
        cause: contender.cause().clone(),
        delta_chi2: contender.gain,
        parameters: contender
            .fit
            .parameters_of(contender.fit.causes.len() - 1)
            .len(),
        score: contender.score(),
        angle_rad: cosine(&signature, &self::signature(round, contender)).acos(),
        holdout: Prediction::new(&contender.fit).rms(),
    })
    .collect()
}

/// What a contender changes in the readings that nothing else estimated could.
fn signature(round: &Round<'_>, contender: &Contender<'_>) -> DMatrix<f64> {
    let fit = &contender.fit;
    let linear = Linearisation::new(&fit.problem, &fit.solution);
    let own = fit.parameters_of(fit.causes.len() - 1);
    let columns = linear.design.rows(0, round.scan.linear.rows.len());
    round.scan.space.project(&columns.select_columns(&own))
}

/// The parameters of a cause in the final model.
fn parameters(fit: &Fit<'_>, index: usize) -> Vec<FoundParameter> {
    let before: usize = fit.causes[..index].iter().map(|c| c.instances.len()).sum();
    let cause = &fit.causes[index];
    let several = cause.instances.len() > 1;
    let mut found = Vec::new();
    for (instance, bound) in cause.instances.iter().enumerate() {
        for (number, parameter) in bound.effect.parameters().iter().enumerate() {
            let id = ParameterId::Effect {
                effect: before + instance,
                parameter: number,
            };
            let column = fit.solution.parameters.iter().position(|p| p.id == id);
            found.push(FoundParameter {
                name: parameter.name,
                cable: bound.cables.first().copied().filter(|_| several),
                value: bound.values[number],
                unit: parameter.unit,
                sd: column.and_then(|k| fit.solution.standard_deviation(k)),
            });
        }
    }
    found
}

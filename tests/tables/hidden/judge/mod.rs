//! Compares findings with the hidden effects.

use std::collections::BTreeSet;

use serde::{Deserialize, Serialize};
use tautline_core::diagnosis::{Cause, Finding, Subject, Verdict};
use tautline_core::effect::{BoundEffect, EffectSetting, Scope, Search};
use tautline_core::robot::Robot;

/// Maximum number of causes in an ambiguous finding that counts as found.
pub const MAX_LISTED: usize = 3;

/// Result for one hidden effect, best first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Found {
    /// Named alone.
    Named,
    /// In a list of at most three causes that the data cannot separate.
    Listed,
    /// In a list of at most three causes, some of which fit clearly worse.
    ListedNeedlessly,
    /// In a longer list.
    ListedLong,
    /// Not found; another effect is named.
    OtherNamed,
    /// Not found; there is a list without it.
    OtherListed,
    /// Not found, but an unknown error is reported.
    Unknown,
    /// Not found, and nothing is reported in its place.
    Missed,
}

/// The part of a finding that is compared with the truth.
#[derive(Debug, Clone)]
pub struct Claim {
    /// How certain the finding is.
    pub verdict: Verdict,
    /// The subject and its alternatives.
    pub candidates: Vec<Subject>,
    /// Their stated probabilities.
    pub probabilities: Vec<f64>,
    /// Index of the finding.
    pub finding: usize,
}

impl Claim {
    /// Extracts one claim per finding, or one per reading for outliers that are named together.
    #[must_use]
    pub fn of(findings: &[Finding]) -> Vec<Self> {
        let numbered = findings.iter().enumerate();
        numbered
            .flat_map(|(n, finding)| claims(n, finding))
            .collect()
    }

    /// Identifiers with cable numbers, for tables.
    #[must_use]
    pub fn describe(&self) -> String {
        let names: Vec<String> = self.candidates.iter().map(describe).collect();
        match self.verdict {
            Verdict::Named => names.join(" "),
            Verdict::Ambiguous => names.join(" or "),
            Verdict::Unknown => "unknown".to_owned(),
        }
    }
}

fn claims(finding: usize, of: &Finding) -> Vec<Claim> {
    let is_reading = |cause: &&Cause| matches!(cause.effect().search(), Search::AtPose(_));
    if of.verdict() == Verdict::Named
        && let Some(readings) = of.cause().filter(is_reading)
    {
        let claim = |bound: &BoundEffect| Claim {
            verdict: of.verdict(),
            candidates: vec![Subject::Cause(Cause {
                instances: vec![bound.clone()],
            })],
            probabilities: vec![of.probability],
            finding,
        };
        return readings.instances.iter().map(claim).collect();
    }
    let others = of.alternatives.iter();
    let own = std::iter::once((of.subject.clone(), of.probability));
    let all = own.chain(others.map(|other| (other.subject.clone(), other.probability)));
    let (candidates, probabilities) = all.unzip();
    vec![Claim {
        verdict: of.verdict(),
        candidates,
        probabilities,
        finding,
    }]
}

pub(super) fn describe(subject: &Subject) -> String {
    let id = subject
        .cause()
        .map_or("unknown", |cause| cause.effect().id());
    let cables = subject.cables();
    let cables: Vec<String> = cables.iter().map(|c| (c + 1).to_string()).collect();
    if cables.is_empty() {
        id.to_owned()
    } else {
        format!("{id}:{}", cables.join("+"))
    }
}

/// An effect and its targets, independent of how they are expressed.
#[derive(Debug, Clone, PartialEq)]
struct Identity {
    id: &'static str,
    cables: BTreeSet<usize>,
    poses: Vec<f64>,
}

impl Identity {
    fn of(instances: &[BoundEffect], robot: &Robot) -> Self {
        let effect = instances[0].effect;
        let has_cables = effect.scope() != Scope::Robot || effect.id() == "winch_scale_common";
        let cables = match (has_cables, instances.iter().any(|b| !b.targeted)) {
            (false, _) => BTreeSet::new(),
            (true, true) => (0..robot.cable_count()).collect(),
            (true, false) => instances.iter().flat_map(|b| b.cables.clone()).collect(),
        };
        let pose = pose_parameter(effect.search());
        Self {
            // A common scale of all winches is the same as an equal scale of every winch.
            id: match effect.id() {
                "winch_scale_common" => "winch_scale",
                id => id,
            },
            cables,
            poses: pose.map_or(vec![], |k| instances.iter().map(|b| b.values[k]).collect()),
        }
    }
}

fn pose_parameter(search: Search) -> Option<usize> {
    match search {
        Search::FromPose(k) | Search::AtPose(k) => Some(k),
        _ => None,
    }
}

/// Indices of the hidden effects that a cause describes; empty if it also blames a cable without a hidden effect.
pub(super) fn matched(truths: &[EffectSetting], cause: &Cause, robot: &Robot) -> Vec<usize> {
    let claimed = Identity::of(&cause.instances, robot);
    // A step may seem to be one pose earlier or later, a wrong reading may not.
    let tolerance = match cause.effect().search() {
        Search::FromPose(_) => 1.0,
        _ => 0.0,
    };
    let mut blamed = BTreeSet::new();
    let mut matched = Vec::new();
    for (number, truth) in truths.iter().enumerate() {
        let Ok(bound) = BoundEffect::from_setting(truth, robot) else {
            continue;
        };
        let is_common = truth.effect == "winch_scale_common";
        let truth = Identity::of(&[bound], robot);
        let near = |pose: &f64| claimed.poses.iter().any(|p| (p - pose).abs() <= tolerance);
        let same = truth.id == claimed.id
            && truth.cables.is_subset(&claimed.cables)
            && truth.poses.iter().all(near)
            && (!is_common || has_equal_values(cause));
        if same {
            blamed.extend(truth.cables);
            matched.push(number);
        }
    }
    let one_value = cause.instances.len() == 1;
    if one_value && have_different_values(truths, &matched) {
        // One value for all of these cables describes an effect on all of them, but not an additional effect on one.
        matched.retain(|k| cables_of(&truths[*k], robot) == claimed.cables);
    }
    if blamed == claimed.cables {
        matched
    } else {
        Vec::new()
    }
}

/// Cables of a hidden effect.
fn cables_of(truth: &EffectSetting, robot: &Robot) -> BTreeSet<usize> {
    let bound = BoundEffect::from_setting(truth, robot);
    bound.map_or_else(|_| BTreeSet::new(), |b| Identity::of(&[b], robot).cables)
}

/// Whether hidden effects on several cables have values too different for a common one.
fn have_different_values(truths: &[EffectSetting], of: &[usize]) -> bool {
    let values: Vec<f64> = of
        .iter()
        .filter_map(|k| truths[*k].parameters.values().next().copied())
        .collect();
    of.len() > 1 && !are_nearly_equal(&values)
}

/// Whether the instances of a cause have about the same value.
fn has_equal_values(cause: &Cause) -> bool {
    let values = cause.instances.iter().filter_map(|b| b.values.first());
    are_nearly_equal(&values.copied().collect::<Vec<f64>>())
}

fn are_nearly_equal(values: &[f64]) -> bool {
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    high - low <= 0.25 * (high + low).abs()
}

/// Compares claims with the hidden effects. For each hidden effect, returns the result and the index of the claim that
/// decides it.
#[must_use]
pub fn judge(
    truths: &[EffectSetting],
    claims: &[Claim],
    robot: &Robot,
) -> Vec<(Found, Option<usize>)> {
    let hits: Vec<BTreeSet<usize>> = claims
        .iter()
        .map(|claim| hits(truths, claim, robot))
        .collect();
    let best = |truth: usize| {
        let by = claims.iter().zip(&hits).enumerate();
        let found = by.filter_map(|(n, (claim, hits))| {
            let of_it = hits.contains(&truth);
            Some((rank(claim, of_it, hits.is_empty())?, Some(n)))
        });
        found.min().unwrap_or((Found::Missed, None))
    };
    (0..truths.len()).map(best).collect()
}

/// Indices of the hidden effects among the candidates of a claim.
fn hits(truths: &[EffectSetting], claim: &Claim, robot: &Robot) -> BTreeSet<usize> {
    let causes = claim.candidates.iter().filter_map(Subject::cause);
    causes
        .flat_map(|cause| matched(truths, cause, robot))
        .collect()
}

/// Result of one claim for a hidden effect; `None` if the claim is about another hidden effect.
fn rank(claim: &Claim, of_it: bool, of_none: bool) -> Option<Found> {
    match (claim.verdict, of_it) {
        (Verdict::Named, true) => Some(Found::Named),
        (Verdict::Ambiguous, true) if claim.candidates.len() <= MAX_LISTED => Some(Found::Listed),
        (Verdict::Ambiguous, true) => Some(Found::ListedLong),
        _ if !of_none => None,
        (Verdict::Unknown, _) => Some(Found::Unknown),
        (Verdict::Named, false) => Some(Found::OtherNamed),
        (Verdict::Ambiguous, false) => Some(Found::OtherListed),
    }
}

/// Effects that are named although they are not hidden.
#[must_use]
pub fn wrong_names(truths: &[EffectSetting], claims: &[Claim], robot: &Robot) -> Vec<String> {
    claims
        .iter()
        .filter(|claim| claim.verdict == Verdict::Named && hits(truths, claim, robot).is_empty())
        .map(Claim::describe)
        .collect()
}

#[cfg(test)]
mod tests;

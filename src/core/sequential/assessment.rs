//! Assessment of the goals from the measured poses.

use super::goal::Goal;
use crate::diagnosis::{
    Cause, CauseSet, Diagnosis, EXPECTED_CAUSES, Finding, UnseenFault, Verdict,
};
use crate::effect::{BoundEffect, Search};
use crate::planning::Prospects;

use super::choice::largest_sd_m;
use super::{FaultOfInterest, is_same_target, scaled};

/// A fault of the size of interest that the readings do not exclude.
#[derive(Debug, Clone)]
pub struct PossibleFault {
    /// Effect and target, at the size of interest.
    pub cause: Cause,
    /// Posterior odds that it is present, of this size or larger, against nothing beside the findings.
    pub odds: f64,
}

/// Assessment of the measured poses.
#[derive(Debug, Clone)]
pub struct Assessment {
    /// Number of measured poses, the home pose not counted.
    pub poses: usize,
    /// Largest standard deviation of a coordinate of an entry point (m); `None` while the readings do not determine it.
    pub largest_sd_m: Option<f64>,
    /// Probability that exactly the findings are present: the product of their stated probabilities and of
    /// [`Self::no_further_fault`]. Zero if a finding is ambiguous or has no name.
    pub explained: f64,
    /// Probability that no fault of the size of interest that the instruments can show is present beside the findings.
    pub no_further_fault: f64,
    /// The findings.
    pub findings: Vec<Finding>,
    /// Sets of causes that are possible, most probable first.
    pub sets: Vec<CauseSet>,
    /// Faults that the readings do not exclude, most probable first, without those that the instruments cannot show.
    pub unseen: Vec<PossibleFault>,
}

impl Assessment {
    /// `shown` are the faults that the instruments can show at all.
    pub(super) fn new(
        poses: usize,
        prospects: &Prospects,
        diagnosis: Option<Diagnosis>,
        shown: &[FaultOfInterest],
    ) -> Self {
        let mut assessment = Self {
            poses,
            largest_sd_m: largest_sd_m(&prospects.geometry, &prospects.geometry.common),
            explained: 0.0,
            no_further_fault: 0.0,
            findings: Vec::new(),
            sets: Vec::new(),
            unseen: Vec::new(),
        };
        let Some(diagnosis) = diagnosis else {
            return assessment;
        };
        let unseen = UnseenOfInterest::new(&diagnosis, shown);
        assessment.unseen = unseen.possible_faults();
        let single: f64 = assessment.unseen.iter().map(|fault| fault.odds).sum();
        // The search knows sets of several causes, at several noises and by full fits; the sum over single faults also those that the
        // search leaves out as improbable.
        let odds = single.max(unseen.odds_of_larger_sets(&diagnosis));
        assessment.no_further_fault = 1.0 / (1.0 + odds);
        let of = |finding: &Finding| match finding.verdict() {
            Verdict::Named => finding.probability,
            Verdict::Ambiguous | Verdict::Unknown => 0.0,
        };
        let named: f64 = diagnosis.findings.iter().map(of).product();
        assessment.explained = named * assessment.no_further_fault;
        assessment.findings = diagnosis.findings;
        assessment.sets = diagnosis.sets;
        assessment
    }

    /// Probability that no fault is present, as far as the instruments can show it; zero if one was found.
    #[must_use]
    pub fn fault_free(&self) -> f64 {
        match self.findings.is_empty() {
            true => self.no_further_fault,
            false => 0.0,
        }
    }

    /// Whether a goal is reached.
    #[must_use]
    pub fn reaches(&self, goal: Goal) -> bool {
        match goal {
            Goal::Accuracy(limit_m) => self.largest_sd_m.is_some_and(|sd_m| sd_m <= limit_m),
            Goal::Cause(probability) => self.explained >= probability,
            Goal::FaultFree(probability) => self.fault_free() >= probability,
        }
    }

    /// Whether channels are exchanged, so that the sets of causes refer to corrected readings rather than to those of the
    /// dataset.
    pub(super) fn has_exchanged_channels(&self) -> bool {
        let causes = self.findings.iter().filter_map(Finding::cause);
        causes
            .map(|cause| cause.effect().search())
            .any(|search| search == Search::Exchange)
    }
}

/// Faults of the size of interest that may be present beside the findings.
/// The prior of the diagnosis expects [`EXPECTED_CAUSES`] of any size, shown or not. Here the same number is expected of faults
/// that are of the size of interest and can be shown: a robot does not have fewer of them because it has few instruments.
struct UnseenOfInterest<'d> {
    /// Faults with their sizes of interest.
    faults: Vec<(&'d UnseenFault, &'d FaultOfInterest)>,
    /// Prior odds here over those of the diagnosis.
    raised: f64,
}

impl<'d> UnseenOfInterest<'d> {
    fn new(diagnosis: &'d Diagnosis, shown: &'d [FaultOfInterest]) -> Self {
        let of_interest = |fault: &'d UnseenFault| {
            let own = &fault.cause.instances[0];
            let mut shown = shown.iter();
            let shown = shown.find(|shown| is_same_target(&shown.cause.instances[0], own))?;
            Some((fault, shown))
        };
        let faults: Vec<_> = diagnosis.unseen.iter().filter_map(of_interest).collect();
        let expected: f64 = (faults.iter())
            .map(|(fault, shown)| fault.prior_odds_beyond(shown.factor))
            .sum();
        Self {
            faults,
            raised: (EXPECTED_CAUSES / expected.max(f64::MIN_POSITIVE)).max(1.0),
        }
    }

    /// The faults with their odds, most probable first.
    fn possible_faults(&self) -> Vec<PossibleFault> {
        let all = self.faults.iter().map(|(fault, shown)| PossibleFault {
            cause: scaled(&fault.cause, shown.factor),
            odds: self.raised * fault.odds_beyond(shown.factor),
        });
        let mut all: Vec<PossibleFault> = all.collect();
        all.sort_by(|a, b| b.odds.total_cmp(&a.odds));
        all
    }

    /// Odds of the sets that have a fault of the size of interest beside the findings.
    fn odds_of_larger_sets(&self, diagnosis: &Diagnosis) -> f64 {
        let known: Vec<&Cause> = diagnosis
            .findings
            .iter()
            .filter_map(Finding::cause)
            .collect();
        let further = |set: &CauseSet| -> f64 {
            let is_further = |cause: &&Cause| {
                let is_it = |known: &&Cause| known.instances.iter().any(|own| has(cause, own));
                !known.iter().any(is_it)
            };
            let beyond = set
                .causes
                .iter()
                .filter(is_further)
                .map(|cause| self.share_of_interest(cause));
            beyond.fold(0.0, f64::max)
        };
        let larger = diagnosis
            .sets
            .iter()
            .filter(|set| set.causes.len() > known.len());
        let probability: f64 = larger.map(|set| set.probability * further(set)).sum();
        self.raised * probability / (1.0 - probability.min(1.0))
    }

    /// Probability that a cause is of the size of interest if it is present: the largest over its instances.
    fn share_of_interest(&self, cause: &Cause) -> f64 {
        let of = self
            .faults
            .iter()
            .filter(|(fault, _)| has(cause, &fault.cause.instances[0]));
        of.map(|(fault, shown)| fault.share_beyond(shown.factor))
            .fold(0.0, f64::max)
    }
}

/// Whether a cause includes an effect on its targets.
fn has(cause: &Cause, bound: &BoundEffect) -> bool {
    cause.instances.iter().any(|own| is_same_target(own, bound))
}

//! What the measured poses tell about the goals.

use super::goal::Goal;
use crate::diagnosis::{
    Cause, CauseSet, Diagnosis, Finding, UnseenFault, Verdict, stated_probability,
};
use crate::effect::Search;
use crate::planning::Prospects;

use super::choice::largest_sd_m;

/// A fault of the size of interest that the readings do not exclude.
#[derive(Debug, Clone)]
pub struct PossibleFault {
    /// Effect and target, at the size of interest.
    pub cause: Cause,
    /// Posterior odds that it is present, of this size or larger, against nothing beside the findings.
    pub odds: f64,
}

/// What is known after some poses.
#[derive(Debug, Clone)]
pub struct Assessment {
    /// Number of measured poses, the home pose not counted.
    pub poses: usize,
    /// Largest standard deviation of a coordinate of an entry point (m); `None` while the readings do not determine it.
    pub largest_sd_m: Option<f64>,
    /// Probability that the findings are what is wrong and nothing else is: the product of their stated probabilities and of
    /// [`Self::no_further_fault`]. Zero if one of them is ambiguous or has no name.
    pub explained: f64,
    /// Probability that no fault of the size of interest is present beside the findings, of those that the instruments can show.
    pub no_further_fault: f64,
    /// The findings.
    pub findings: Vec<Finding>,
    /// Sets of causes that are possible, most probable first.
    pub sets: Vec<CauseSet>,
    /// Faults that the readings do not exclude, most probable first, without those that the instruments cannot show.
    pub unseen: Vec<PossibleFault>,
}

impl Assessment {
    /// `of_interest` sizes the faults that the instruments can show at all.
    pub(super) fn new(
        poses: usize,
        prospects: &Prospects,
        diagnosis: Option<Diagnosis>,
        of_interest: impl Fn(&UnseenFault) -> Option<PossibleFault>,
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
        assessment.unseen = diagnosis.unseen.iter().filter_map(of_interest).collect();
        assessment.unseen.sort_by(|a, b| b.odds.total_cmp(&a.odds));
        let odds: f64 = assessment.unseen.iter().map(|fault| fault.odds).sum();
        // The search knows sets of several causes of any size, the odds also faults that it leaves out as improbable.
        let known = diagnosis
            .findings
            .iter()
            .filter(|finding| finding.cause().is_some())
            .count();
        let larger = diagnosis.sets.iter().filter(|set| set.causes.len() > known);
        let more: f64 = larger.map(|set| set.probability).sum();
        let by_search = 1.0 - stated_probability(more.min(1.0));
        assessment.no_further_fault = by_search.min(1.0 / (1.0 + odds));
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

    /// Whether channels are exchanged, so that sets of causes are about other readings than those of the dataset.
    pub(super) fn has_exchanged_channels(&self) -> bool {
        let causes = self.findings.iter().filter_map(Finding::cause);
        causes
            .map(|cause| cause.effect().search())
            .any(|search| search == Search::Exchange)
    }
}

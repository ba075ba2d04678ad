//! Which causes the data ask for: added one by one, exchanged where another fits better, taken back where not
//! needed.

use super::DiagnosisOptions;
use super::fit::Fit;
use super::report::Cause;
use super::scores::{Scan, Scored, scan};
use crate::effect::{BoundEffect, Search};
use crate::estimation::{EstimationError, Problem};

/// Most causes that are fitted completely in each round.
const REFITS: usize = 32;
/// Difference of the evidence (twice its logarithm) at which one cause stands out from another.
pub(super) const CLEAR: f64 = 9.0;

/// A cause fitted completely in a given place.
#[derive(Debug, Clone)]
pub(super) struct Contender<'a> {
    pub fit: Fit<'a>,
    pub scored: Scored,
    /// Gain of chi-square over the model without it.
    pub gain: f64,
    /// What its freedom is worth.
    pub freedom: f64,
}

impl Contender<'_> {
    pub fn score(&self) -> f64 {
        self.gain - self.freedom
    }

    /// The cause with the values fitted; it is the last of the fit.
    pub fn cause(&self) -> &Cause {
        self.fit.causes.last().unwrap_or(&self.scored.cause)
    }
}

/// Fits the most promising causes of a scan on top of `fit`; the best first.
pub(super) fn contenders<'a>(
    base: &Problem<'a>,
    fit: &Fit<'a>,
    scan: &Scan,
) -> Result<Vec<Contender<'a>>, EstimationError> {
    let is_new = |scored: &&Scored| {
        let known = |cause: &Cause| is_contained(&scored.cause, cause);
        scored.visible > 0 && !fit.causes.iter().any(known)
    };
    let mut promising: Vec<&Scored> = scan.scored.iter().filter(is_new).collect();
    promising.sort_by(|a, b| b.score().total_cmp(&a.score()));
    let mut found = Vec::new();
    for scored in promising.into_iter().take(REFITS) {
        let mut causes = fit.causes.clone();
        causes.push(scored.cause.clone());
        let refit = Fit::new(base, &causes)?;
        let positions = match scored.cause.effect().search() {
            Search::FromPose(_) | Search::AtPose(_) => {
                2.0 * (scan.linear.poses.len().max(1) as f64).ln()
            }
            _ => 0.0,
        };
        let freedom = refit.freedom_of(causes.len() - 1);
        found.push(Contender {
            gain: fit.solution.chi2 - refit.solution.chi2,
            freedom: freedom.map_or(scored.freedom, |f| f + positions),
            scored: scored.clone(),
            fit: refit,
        });
    }
    found.sort_by(|a, b| b.score().total_cmp(&a.score()));
    Ok(found)
}

/// Whether a cause has an instance that the other has already, or that acts on a part of its cables.
fn is_contained(cause: &Cause, other: &Cause) -> bool {
    let pair = |one: &BoundEffect, other: &BoundEffect| {
        let event = match one.effect.search() {
            Search::FromPose(pose) | Search::AtPose(pose) => Some(pose),
            _ => None,
        };
        one.effect.id() == other.effect.id()
            && one.targeted == other.targeted
            && one.cables == other.cables
            && event.is_none_or(|pose| one.values[pose] == other.values[pose])
    };
    let instances = || cause.instances.iter();
    instances().any(|one| other.instances.iter().any(|other| pair(one, other)))
}

/// The selected causes with everything that was asked at the end.
pub(super) struct Selection<'a> {
    pub base: Fit<'a>,
    pub fit: Fit<'a>,
    /// Scan of the model without any cause.
    pub first: Scan,
}

/// Adds causes until what is left is noise.
pub(super) fn select<'a>(
    base: &Problem<'a>,
    options: &DiagnosisOptions,
) -> Result<Selection<'a>, EstimationError> {
    let start = Fit::new(base, &[])?;
    let first = scan(&start);
    let mut fit = start.clone();
    let mut present = first.clone();
    while fit.causes.len() < options.most_findings {
        let level = options.alpha / present.questions.max(1) as f64;
        let significant = present.scored.iter().any(|s| s.p_value < level);
        if !significant {
            break;
        }
        let found = contenders(base, &fit, &present)?;
        let Some(best) = found.into_iter().find(|c| c.scored.p_value < level) else {
            break;
        };
        if best.score() <= 0.0 {
            break;
        }
        fit = best.fit;
        present = scan(&fit);
    }
    Ok(Selection {
        base: start,
        fit,
        first,
    })
}

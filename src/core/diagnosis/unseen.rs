//! Faults that the readings do not exclude, by their size.
//!
//! A diagnosis that finds nothing says little as long as the readings could not show a fault. Beside the causes found, the
//! posterior odds that one more cause is present with at least some size are, with the evidence of [`crate::evidence`],
//!
//! ```text
//! odds = sum over scales of  prior odds x evidence x P(|phi| >= size | readings)
//! ```
//!
//! where the coordinates `phi` are normal given the readings, and sizes are compared in units of the prior. A cause on which the
//! readings do not depend keeps the odds that it has before them.

use nalgebra::{DMatrix, DVector};

use super::candidates::Candidate;
use super::gram::{CandidateScore, Gram};
use super::relations::is_same_effect_and_targets;
use super::report::UnseenFault;
use super::size_posterior::SizePosterior;
use crate::evidence::Evidence;

/// All faults that are not among the causes of the fit, in the order of the catalogue.
pub(super) fn unseen_faults(gram: &Gram<'_>, present: &[usize]) -> Vec<UnseenFault> {
    let mut faults: Vec<UnseenFault> = Vec::new();
    for (index, candidate) in gram.candidates.iter().enumerate() {
        let is_known = present
            .iter()
            .any(|k| *k == index || gram.candidates[*k].excludes(candidate));
        if candidate.is_family() || is_known {
            continue;
        }
        let sizes = SizePosterior::at_scales(candidate, &gram.scores[index]);
        match faults.last_mut() {
            // Poses of an event and periods of a wave share the prior probability of one fault.
            Some(last) if is_same_effect_and_targets(&last.cause, &candidate.cause) => {
                last.sizes.extend(sizes);
            }
            _ => faults.push(UnseenFault {
                cause: candidate.typical(),
                sizes,
            }),
        }
    }
    faults
}

impl SizePosterior {
    fn at_scales(candidate: &Candidate, alone: &CandidateScore) -> Vec<Self> {
        let typical = DVector::from_vec(candidate.coordinates(&candidate.typical()));
        let Some(typical) = candidate.prior.clone().lu().solve(&typical) else {
            return Vec::new();
        };
        let at_scale = |scale: &(f64, f64)| Self::new(candidate, alone, *scale, typical.norm());
        candidate.scales.iter().filter_map(at_scale).collect()
    }

    fn new(
        candidate: &Candidate,
        alone: &CandidateScore,
        (scale, log_weight): (f64, f64),
        typical: f64,
    ) -> Option<Self> {
        let prior = &candidate.prior * scale;
        let evidence = Evidence::with_prior(&alone.score, &alone.information, &prior)?;
        let mean = evidence.mean();
        let identity = DMatrix::identity(mean.len(), mean.len());
        let root = (evidence.factor.l()).tr_solve_lower_triangular(&identity)?;
        let log_prior = candidate.log_odds + log_weight;
        Some(Self {
            prior_odds: log_prior.exp(),
            odds: (log_prior + evidence.log()).exp(),
            typical: typical / scale,
            is_positive: candidate.is_positive,
            mean,
            root,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::normal_points::normal_points;

    fn posterior(is_positive: bool) -> SizePosterior {
        SizePosterior {
            prior_odds: 0.2,
            odds: 0.5,
            typical: 0.3,
            is_positive,
            mean: DVector::from_element(1, 0.4),
            root: DMatrix::from_element(1, 1, 0.7),
        }
    }

    #[test]
    fn one_coordinate_is_shared_as_points_of_it_are() {
        let points = normal_points(1, 4096) * 0.7;
        let share = |is_beyond: &dyn Fn(f64) -> bool| {
            let beyond = points.iter().filter(|point| is_beyond(**point + 0.4));
            beyond.count() as f64 / 4096.0
        };
        let both = share(&|value| value.abs() >= 0.9);
        assert!((posterior(false).odds_beyond(3.0) - 0.5 * both).abs() < 1e-3);
        let above = 2.0 * share(&|value| value >= 0.9);
        assert!((posterior(true).odds_beyond(3.0) - 0.5 * above).abs() < 1e-3);
    }

    #[test]
    fn before_the_readings_sizes_are_those_of_the_prior() {
        // Two thirds of a standard normal number lie within 0.9674 of zero.
        let odds = posterior(false).prior_odds_beyond(0.9674 / 0.3);
        assert!((odds - 0.2 / 3.0).abs() < 1e-4, "{odds}");
        assert!((posterior(true).prior_odds_beyond(0.0) - 0.2).abs() < 1e-12);
    }

    #[test]
    fn larger_faults_are_less_probable() {
        let odds = [0.0, 0.5, 1.0, 4.0, 20.0].map(|factor| posterior(false).odds_beyond(factor));
        assert!((odds[0] - 0.5).abs() < 1e-12, "{odds:?}");
        assert!(odds.is_sorted_by(|a, b| a > b), "{odds:?}");
        assert!(odds[4] < 1e-12);
    }
}

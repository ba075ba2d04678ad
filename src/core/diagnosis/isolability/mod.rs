//! Predicts before any measurement which faults a set of planned poses would reveal, and which of them could be told
//! apart.
//!
//! Isolability (Gertler, Fault Detection and Diagnosis in Engineering Systems, 1998; Isermann, Fault-Diagnosis Systems,
//! 2006) is a property of the poses and the sensors. With the linearisation of all candidates that the diagnosis uses,
//! the score of a candidate `c` in data with a fault `a` of size `phi` is normal,
//!
//! ```text
//! b_c ~ N(-G_ca phi, G_cc)
//! ```
//!
//! with the Gram matrix `G` of the columns after elimination of poses, tensions, geometry and the deviations of parts within
//! their tolerances, stated or typical ones; the scores of two candidates are jointly normal with the corresponding blocks. `lambda = phi^T G_aa phi` is the noncentrality: the
//! chi-square of a model without the fault for data without noise. The log posterior odds of a candidate against no
//! cause follow from the evidence of [`super::evidence`] and the candidate's prior. They are a function `L_c(b_c)` of
//! its score alone, so that
//!
//! - the **probability of detection** is `P(L_a >= ln 19)`, with the odds at which the diagnosis names or lists a
//!   cause;
//! - the **probability of confusion** with `c` is `P(max(L_a, L_c) >= ln 19 and L_a - L_c < ln 19)`: something is
//!   detected, but `c` is not ruled out;
//! - the **expected log Bayes factor** of `a` over `c` is `E[ln p(y | a) - ln p(y | c)]`, for which
//!   `E[b^T W b] = m^T W m + tr(W G)` with the mean `m`.
//!
//! Noise is taken as described, parts scatter by their tolerances, and other causes are absent: a fault below the tolerance
//! of its part is none. Probabilities are means over a low-discrepancy sequence of
//! normal variables with as many dimensions as the faults have parameters (Halton, Numerische Mathematik 2, 1960;
//! Niederreiter, Random Number Generation and Quasi-Monte Carlo Methods, 1992).

mod odds;
#[cfg(test)]
mod tests;

use nalgebra::{DMatrix, DVector};

use super::budget::{ISOLABILITY_POINTS, RULED_OUT};
use super::calibration::log_naming_odds;
use super::candidates::{Candidate, size_parameter};
use super::fit::Fit;
use super::fitted_problem::{problem_at_fitted_poses, with_assumed_tolerances};
use super::gram::{CandidateScore, Gram};
use super::linear_fit::LinearFit;
use super::normal_points::normal_points;
use super::priors::AS_STATED;
use super::relations::is_same_effect_and_targets;
use super::report::Cause;
use crate::effect::measurements_as_modelled;
use crate::estimation::EstimationError;
use crate::measurement::Dataset;
use crate::statistics::covariance_root;
use odds::Evidence;

/// A fault of typical size, with its probability of detection.
#[derive(Debug, Clone)]
pub struct ExpectedFault {
    /// The effect on its targets. Events are at a pose in the middle, waves have a period in the middle of those tried.
    pub cause: Cause,
    /// Noncentrality `lambda`: chi-square of a model without the fault for data without noise.
    pub noncentrality: f64,
    /// Probability that the fault is named or listed.
    pub detection: f64,
}

/// Expected separability of a fault from another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExpectedPair {
    /// Expected log Bayes factor of the fault that is present over the other one.
    pub log_bayes_factor: f64,
    /// Probability that something is detected but the other fault is not ruled out.
    pub confusion: f64,
}

/// Faults that planned poses would reveal.
#[derive(Debug, Clone)]
pub struct Isolability {
    /// All faults that affect a reading.
    pub faults: Vec<ExpectedFault>,
    pairs: Vec<ExpectedPair>,
}

impl Isolability {
    /// Expected separability of the fault with index `present` from that with index `other`.
    #[must_use]
    pub fn pair(&self, present: usize, other: usize) -> ExpectedPair {
        self.pairs[present * self.faults.len() + other]
    }

    /// Indices of the faults that may be confused with one, with a probability of at least `least`, the most probable
    /// first.
    #[must_use]
    pub fn rivals(&self, present: usize, least: f64) -> Vec<usize> {
        let confusion = |other: &usize| self.pair(present, *other).confusion;
        let others = (0..self.faults.len()).filter(|other| *other != present);
        let mut rivals: Vec<usize> = others.filter(|other| confusion(other) >= least).collect();
        rivals.sort_by(|a, b| confusion(b).total_cmp(&confusion(a)).then(a.cmp(b)));
        rivals
    }
}

/// Predicts the faults that the poses of a dataset would reveal. The values of its readings do not matter, only which readings
/// there are at which poses.
///
/// # Errors
/// If the readings cannot be used with the robot.
pub fn isolability(dataset: &Dataset) -> Result<Isolability, EstimationError> {
    let dataset = Dataset {
        robot: with_assumed_tolerances(&dataset.robot),
        measurements: dataset.measurements.clone(),
    };
    let problem = problem_at_fitted_poses(&dataset)?;
    let fit = Fit::new(&problem, &[])?;
    let linear_fit = LinearFit::new(&fit, true);
    let mut gram = linear_fit.gram(&linear_fit.linear.described(AS_STATED));
    let candidates: Vec<CandidateFault> = representatives(gram.candidates)
        .into_iter()
        .map(|index| CandidateFault::new(&gram, index))
        .collect();
    Ok(ExpectedScores::new(&mut gram, candidates).isolability())
}

/// Visibility of a fault at the poses of a dataset.
#[derive(Debug, Clone)]
pub struct ShownFault {
    /// Effect and target, at typical size.
    pub cause: Cause,
    /// Chi-square of a model without the fault for data without noise, at typical size.
    pub noncentrality: f64,
    /// Smallest and largest typical size, as multiples of this one.
    pub typical_range: [f64; 2],
}

/// Visibility of each fault at the poses of a dataset. As for [`isolability`], the values of the readings do not matter.
///
/// # Errors
/// If the readings cannot be used with the robot.
pub fn shown_faults(dataset: &Dataset) -> Result<Vec<ShownFault>, EstimationError> {
    let dataset = Dataset {
        robot: with_assumed_tolerances(&dataset.robot),
        measurements: dataset.measurements.clone(),
    };
    let problem = problem_at_fitted_poses(&dataset)?;
    let fit = Fit::new(&problem, &[])?;
    let linear_fit = LinearFit::new(&fit, true);
    let gram = linear_fit.gram(&linear_fit.linear.described(AS_STATED));
    let shown = |index: usize| {
        let parameter = size_parameter(gram.candidates[index].effect())?;
        let fault = CandidateFault::new(&gram, index);
        let square = &gram.scores[index].information * &fault.size;
        Some(ShownFault {
            noncentrality: fault.size.dot(&square),
            typical_range: parameter
                .typical_sizes()
                .map(|size| size / parameter.typical_size()),
            cause: fault.cause,
        })
    };
    let indices = representatives(gram.candidates).into_iter();
    Ok(indices.filter_map(shown).collect())
}

/// Log posterior odds of single causes against no cause in the readings of a dataset, with noise as described: the
/// quantity that [`isolability`] predicts. Minus infinity for causes that affect no reading.
///
/// # Errors
/// If the readings cannot be used with the robot.
pub fn log_odds(dataset: &Dataset, causes: &[Cause]) -> Result<Vec<f64>, EstimationError> {
    let measurements = measurements_as_modelled(&dataset.robot, &dataset.measurements)?;
    let dataset = Dataset {
        robot: with_assumed_tolerances(&dataset.robot),
        measurements: measurements.into_owned(),
    };
    let problem = problem_at_fitted_poses(&dataset)?;
    let fit = Fit::new(&problem, &[])?;
    let linear_fit = LinearFit::new(&fit, true);
    let gram = linear_fit.gram(&linear_fit.linear.described(AS_STATED));
    let odds_of = |cause: &Cause| {
        let index = gram.candidates.iter().position(|c| c.represents(cause));
        index.map_or(f64::NEG_INFINITY, |index| {
            let CandidateScore { score, information } = &gram.scores[index];
            Evidence::new(&gram.candidates[index], information).log_odds(score.as_slice())
        })
    };
    Ok(causes.iter().map(odds_of).collect())
}

/// Selects one candidate for each effect and target: events in the middle of the poses, waves in the middle of the
/// periods. Families are left out, because they are no additional faults.
fn representatives(candidates: &[Candidate]) -> Vec<usize> {
    let mut chosen = Vec::new();
    let mut first = 0;
    for until in 1..=candidates.len() {
        if until < candidates.len()
            && is_same_effect_and_targets(&candidates[until].cause, &candidates[first].cause)
        {
            continue;
        }
        let middle = usize::midpoint(first, until - 1);
        if !candidates[middle].is_family() {
            chosen.push(middle);
        }
        first = until;
    }
    chosen
}

struct CandidateFault {
    cause: Cause,
    evidence: Evidence,
    /// Index of its first column in the catalogue.
    first: usize,
    /// Its coordinates at typical size.
    size: DVector<f64>,
}

impl CandidateFault {
    fn new(gram: &Gram<'_>, index: usize) -> Self {
        let candidate = &gram.candidates[index];
        let cause = candidate.typical();
        Self {
            evidence: Evidence::new(candidate, &gram.scores[index].information),
            first: gram.first[index],
            size: DVector::from_vec(candidate.coordinates(&cause)),
            cause,
        }
    }
}

/// All candidate faults, with the Gram matrix of their columns.
struct ExpectedScores {
    candidates: Vec<CandidateFault>,
    /// Index of the first column of each fault in `gram`.
    first: Vec<usize>,
    gram: DMatrix<f64>,
    /// Mean of all scores for each fault, one column per fault: `-G phi`.
    means: DMatrix<f64>,
    /// Normal points for pairs, by number of dimensions.
    points: Vec<DMatrix<f64>>,
}

impl ExpectedScores {
    fn new(gram: &mut Gram<'_>, candidates: Vec<CandidateFault>) -> Self {
        let mut columns = Vec::new();
        let mut first = Vec::new();
        for one in &candidates {
            first.push(columns.len());
            columns.extend(one.first..one.first + one.size.len());
        }
        let mut matrix = DMatrix::zeros(columns.len(), columns.len());
        for (from, column) in columns.iter().enumerate() {
            let row = gram.row(*column);
            for (to, other) in columns.iter().enumerate() {
                matrix[(from, to)] = row[*other];
            }
        }
        let matrix = (&matrix + matrix.transpose()) * 0.5;
        let mut means = DMatrix::zeros(columns.len(), candidates.len());
        for (index, one) in candidates.iter().enumerate() {
            let block = matrix.columns(first[index], one.size.len());
            // Residuals are predictions minus readings.
            means.set_column(index, &(block * &one.size * -1.0));
        }
        let most = candidates
            .iter()
            .map(|one| one.size.len())
            .max()
            .unwrap_or(0);
        let points = (0..=2 * most)
            .map(|count| normal_points(count, ISOLABILITY_POINTS[1]))
            .collect();
        Self {
            candidates,
            first,
            gram: matrix,
            means,
            points,
        }
    }

    fn isolability(&self) -> Isolability {
        let count = self.candidates.len();
        let mut pairs = Vec::with_capacity(count * count);
        for present in 0..count {
            pairs.extend((0..count).map(|other| self.pair(present, other)));
        }
        let fault = |index: usize| ExpectedFault {
            cause: self.candidates[index].cause.clone(),
            noncentrality: self.noncentrality(index),
            detection: self.detection(index),
        };
        Isolability {
            faults: (0..count).map(fault).collect(),
            pairs,
        }
    }

    fn block(&self, one: usize, other: usize) -> DMatrix<f64> {
        let [a, b] = [one, other].map(|k| (self.first[k], self.candidates[k].size.len()));
        self.gram.view((a.0, b.0), (a.1, b.1)).into_owned()
    }

    /// Mean of the score of candidate `k` if `present` is the fault.
    fn mean(&self, present: usize, k: usize) -> DVector<f64> {
        let mean = self.means.column(present);
        mean.rows(self.first[k], self.candidates[k].size.len())
            .into_owned()
    }

    fn noncentrality(&self, index: usize) -> f64 {
        -self.mean(index, index).dot(&self.candidates[index].size)
    }

    fn detection(&self, index: usize) -> f64 {
        let points = normal_points(self.candidates[index].size.len(), ISOLABILITY_POINTS[0]);
        let mut scores = covariance_root(&self.block(index, index)) * points;
        let mean = self.mean(index, index);
        let evidence = &self.candidates[index].evidence;
        let seen = scores.column_iter_mut().filter_map(|mut score| {
            score += &mean;
            is_seen(evidence.log_odds(score.as_slice())).then_some(())
        });
        seen.count() as f64 / ISOLABILITY_POINTS[0] as f64
    }

    fn pair(&self, present: usize, other: usize) -> ExpectedPair {
        let [one, rival] = [present, other].map(|k| &self.candidates[k].evidence);
        let [near, far] = [present, other].map(|k| self.mean(present, k));
        let (within, beside) = (self.block(present, present), self.block(other, other));
        ExpectedPair {
            log_bayes_factor: one.expected(&near, &within) - rival.expected(&far, &beside),
            confusion: self.confusion(present, other, (&near, &within), (&far, &beside)),
        }
    }

    fn confusion(
        &self,
        present: usize,
        other: usize,
        (near, within): (&DVector<f64>, &DMatrix<f64>),
        (far, beside): (&DVector<f64>, &DMatrix<f64>),
    ) -> f64 {
        if present == other || self.left_by(present, far, beside) > RULED_OUT {
            return 0.0;
        }
        let count = near.len();
        let both = count + far.len();
        let mut covariance = DMatrix::zeros(both, both);
        let cross = self.block(present, other);
        covariance
            .view_mut((0, 0), within.shape())
            .copy_from(within);
        covariance
            .view_mut((count, count), beside.shape())
            .copy_from(beside);
        covariance
            .view_mut((0, count), cross.shape())
            .copy_from(&cross);
        covariance
            .view_mut((count, 0), (far.len(), count))
            .copy_from(&cross.transpose());
        let mut mean = DVector::zeros(both);
        mean.rows_mut(0, count).copy_from(near);
        mean.rows_mut(count, far.len()).copy_from(far);
        let mut scores = covariance_root(&covariance) * &self.points[both];
        let [one, rival] = [present, other].map(|k| &self.candidates[k].evidence);
        let confused = scores.column_iter_mut().filter_map(|mut score| {
            score += &mean;
            let (first, second) = score.as_slice().split_at(count);
            are_confused((one, first), (rival, second)).then_some(())
        });
        confused.count() as f64 / ISOLABILITY_POINTS[1] as f64
    }

    /// Noncentrality of a fault that another candidate leaves unexplained.
    fn left_by(&self, present: usize, far: &DVector<f64>, beside: &DMatrix<f64>) -> f64 {
        let total = self.noncentrality(present);
        let explained = beside.clone().cholesky();
        total - explained.map_or(0.0, |factor| far.dot(&factor.solve(far)))
    }
}

/// [`is_confused`] for the evidence of the fault that is present and of another one, each with its score.
fn are_confused(present: (&Evidence, &[f64]), other: (&Evidence, &[f64])) -> bool {
    let [least, most] = present.0.bounds(present.1);
    let [other_least, other_most] = other.0.bounds(other.1);
    let needed = log_naming_odds();
    if most.max(other_most) < needed || least - other_most >= needed {
        return false;
    }
    least.max(other_least) >= needed && most - other_least < needed
        || is_confused(present.0.log_odds(present.1), other.0.log_odds(other.1))
}

/// Whether a cause with these log posterior odds against no cause becomes a finding, named or in a list of alternatives.
#[must_use]
pub fn is_seen(log_odds: f64) -> bool {
    log_odds >= log_naming_odds()
}

/// Whether a fault is detected but `other` is not ruled out against the fault that is `present`. Both arguments are log
/// posterior odds against no cause.
#[must_use]
pub fn is_confused(present: f64, other: f64) -> bool {
    is_seen(present.max(other)) && present - other < log_naming_odds()
}

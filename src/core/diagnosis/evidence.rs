//! Log evidence of a set of causes: [`crate::evidence`] with the Gram matrix and the score of the columns of the set. The size
//! prior is a mixture of several scales.

use std::ops::{Range, RangeInclusive};

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use super::budget::{MAX_DEFICIT, STRONG_GAIN};
use super::candidates::Candidate;
use super::catalogue::log_joint_odds_ratio;
use super::gram::{CandidateScore, Gram};
use crate::evidence::{Evidence, log_determinant, log_positive, of_one};
use crate::statistics::log_sum;

/// A cause in a set: index of its candidate, and index of its scale.
pub(super) type Member = (usize, usize);

/// A set of causes with its evidence, prepared for evaluating extensions.
pub(super) struct System {
    pub members: Vec<Member>,
    /// `(L^-1 F^T R)^T` with the rows `R` of the set: one row for each catalogue column that may extend it, one column
    /// per parameter.
    shared: DMatrix<f64>,
    /// Part of each extension column that the set absorbs: the sum of squares of its row of `shared`, and the product
    /// of that row with the score.
    eliminated: DVector<f64>,
    explained: DVector<f64>,
    /// Index of the first extension column in the catalogue.
    offset: usize,
    /// Log evidence and prior of the set.
    pub log_posterior: f64,
    /// Estimated coordinates, member after member.
    pub estimate: DVector<f64>,
    /// The estimate times -1 in units of the prior, the matrix `1 + K` that gave it, and the factor of the prior.
    solution: DVector<f64>,
    matrix: Cholesky<f64, Dyn>,
    factor: DMatrix<f64>,
}

fn scaled_prior(candidate: &Candidate, scale: usize) -> DMatrix<f64> {
    &candidate.prior * candidate.scales[scale].0
}

impl System {
    /// Prepares a set that any candidate may extend.
    pub fn extensible(gram: &mut Gram<'_>, members: &[Member]) -> Self {
        let columns = 0..*gram.first.last().unwrap_or(&0);
        Self::with_columns(gram, members, columns)
    }

    /// Prepares a set that candidates of a range may extend.
    pub fn extensible_by(
        gram: &mut Gram<'_>,
        members: &[Member],
        candidates: RangeInclusive<usize>,
    ) -> Self {
        let columns = gram.first[*candidates.start()]..gram.first[candidates.end() + 1];
        Self::with_columns(gram, members, columns)
    }

    /// Evaluates a set without preparing extensions.
    pub fn new(gram: &mut Gram<'_>, members: &[Member]) -> Self {
        Self::with_columns(gram, members, 0..0)
    }

    fn with_columns(gram: &mut Gram<'_>, members: &[Member], extension: Range<usize>) -> Self {
        let width: usize = members
            .iter()
            .map(|m| gram.candidates[m.0].columns.len())
            .sum();
        let mut factor = DMatrix::zeros(width, width);
        let columns: Vec<usize> = members
            .iter()
            .flat_map(|m| gram.first[m.0]..gram.first[m.0 + 1])
            .collect();
        let among = gram.block(&columns);
        let mut score = DVector::zeros(width);
        let mut k = 0;
        let mut log_prior = 0.0;
        for (index, scale) in members {
            let candidate = &gram.candidates[*index];
            let count = candidate.columns.len();
            let prior = scaled_prior(candidate, *scale);
            factor.view_mut((k, k), (count, count)).copy_from(&prior);
            log_prior += candidate.log_odds + candidate.scales[*scale].1;
            score
                .rows_mut(k, count)
                .copy_from(&gram.scores[*index].score);
            k += count;
        }
        let score = factor.tr_mul(&score);
        let mut matrix = DMatrix::identity(width, width);
        matrix += factor.tr_mul(&among) * &factor;
        let matrix = (&matrix + matrix.transpose()) * 0.5;
        let cholesky = Cholesky::new(matrix).unwrap_or_else(|| {
            // Only rounding can make this matrix, the identity plus a positive semidefinite one, fail.
            Cholesky::pack_dirty(DMatrix::identity(width, width))
        });
        let mut half = score.clone();
        cholesky.l_dirty().solve_lower_triangular_mut(&mut half);
        let mut eliminated = DVector::zeros(extension.len());
        let mut explained = DVector::zeros(extension.len());
        let mut shared = gram.products(extension.clone(), &columns) * &factor;
        if !extension.is_empty() {
            divide_by_factor(&mut shared, cholesky.l_dirty());
            for (column, score) in shared.column_iter().zip(half.iter()) {
                axpy(*score, column.as_slice(), explained.as_mut_slice());
                for (sum, value) in eliminated.iter_mut().zip(column.iter()) {
                    *sum += value * value;
                }
            }
        }
        for (place, (index, _)) in members.iter().enumerate() {
            log_prior += joint_odds_bonus(gram, &members[..place], *index);
        }
        let determinant = log_determinant(&cholesky);
        let solution = cholesky.solve(&score);
        let mut system = Self {
            members: members.to_vec(),
            shared,
            eliminated,
            explained,
            offset: extension.start,
            log_posterior: 0.5 * (half.norm_squared() - determinant) + log_prior,
            estimate: -(&factor * &solution),
            solution,
            matrix: cholesky,
            factor,
        };
        system.log_posterior += system.log_sign_probability(gram.candidates);
        system
    }

    /// Covariance of the estimate.
    pub fn covariance(&self) -> DMatrix<f64> {
        &self.factor * self.matrix.solve(&self.factor.transpose())
    }

    /// A block on the diagonal of `(1 + K)^-1`.
    fn inverse(&self, range: Range<usize>) -> DMatrix<f64> {
        let mut unit = DMatrix::zeros(self.solution.len(), range.len());
        unit.view_mut((range.start, 0), (range.len(), range.len()))
            .fill_with_identity();
        self.matrix.solve_mut(&mut unit);
        unit.rows(range.start, range.len()).into_owned()
    }

    /// The best scale of a member with the others as they are, and the log ratio of the evidence summed over its scales
    /// and that at the best one.
    pub fn best_scale_of(&self, gram: &Gram<'_>, member: usize) -> Option<(usize, f64)> {
        let (index, scale) = self.members[member];
        let candidate = &gram.candidates[index];
        let range = self.parameters(gram.candidates).swap_remove(member);
        // The inverse of the block is the matrix of the member conditional on the others.
        let matrix = self.inverse(range.clone()).cholesky()?.inverse();
        let size = candidate.scales[scale].0;
        let score = &matrix * self.solution.rows_range(range) / size;
        let identity = DMatrix::identity(matrix.nrows(), matrix.nrows());
        let conditional = CandidateScore {
            score,
            information: (matrix - identity) / (size * size),
        };
        let values = conditional.at_scales(candidate);
        let best = values.iter().copied().max_by(|a, b| a.0.total_cmp(&b.0))?;
        let sum = log_sum(values.iter().map(|(value, _)| *value));
        Some((best.1, sum - best.0))
    }

    /// Contribution of the sign constraints to the log evidence.
    fn log_sign_probability(&self, candidates: &[Candidate]) -> f64 {
        let mut k = 0;
        let mut sum = 0.0;
        for (index, _) in &self.members {
            if candidates[*index].is_positive {
                let variance = self.inverse(k..k + 1)[0] * self.factor[(k, k)].powi(2);
                sum += log_positive(self.estimate[k], variance);
            }
            k += candidates[*index].columns.len();
        }
        sum
    }

    /// Range of the parameters of each member.
    pub fn parameters(&self, candidates: &[Candidate]) -> Vec<Range<usize>> {
        let mut end = 0;
        let range = |(index, _): &Member| {
            let first = end;
            end += candidates[*index].columns.len();
            first..end
        };
        self.members.iter().map(range).collect()
    }

    /// Log prior odds of an additional candidate.
    pub fn log_odds(&self, gram: &Gram<'_>, index: usize) -> f64 {
        gram.candidates[index].log_odds + joint_odds_bonus(gram, &self.members, index)
    }

    /// Share of the information on the first parameter of a further candidate that remains when the members are
    /// estimated, too.
    pub fn remaining_information(&self, gram: &Gram<'_>, index: usize) -> f64 {
        let whole = gram.scores[index].information[(0, 0)];
        let remaining = whole - self.eliminated[gram.first[index] - self.offset];
        remaining / whole.max(f64::MIN_POSITIVE)
    }

    /// Gain of the log posterior by an additional candidate, and the scale that maximises it; `None` if it is clearly
    /// below `least`.
    pub fn gain(&self, gram: &Gram<'_>, index: usize, least: f64) -> Option<(f64, usize)> {
        let candidate = &gram.candidates[index];
        let log_odds = self.log_odds(gram, index);
        if candidate.columns.len() == 1 {
            let (score, information) = self.conditional_single_column(gram, index);
            // The evidence is at most half of the largest possible chi-square gain, plus log 2 from a sign constraint.
            let most = 0.5 * score * score + information * (log_odds + std::f64::consts::LN_2);
            if most < information * least {
                return None;
            }
            let value = |scale| {
                (
                    single_column_evidence(candidate, scale, score, information),
                    scale,
                )
            };
            let values = (0..candidate.scales.len()).map(value);
            let (value, scale) = values.max_by(|a, b| a.0.total_cmp(&b.0))?;
            let value = value + log_odds;
            return (value >= least).then_some((value, scale));
        }
        let conditional = self.conditional(gram, index).in_prior_units(candidate);
        best_scale(candidate, &conditional, least).map(|(value, scale)| (value + log_odds, scale))
    }

    /// Score and information of an additional candidate, conditional on estimating the members.
    fn conditional(&self, gram: &Gram<'_>, index: usize) -> CandidateScore {
        let alone = &gram.scores[index];
        let first = gram.first[index] - self.offset;
        let count = alone.score.len();
        let rows = self.shared.rows(first, count).into_owned();
        CandidateScore {
            score: &alone.score - self.explained.rows(first, count),
            information: &alone.information - &rows * rows.transpose(),
        }
    }

    /// The same for a candidate with a single column, in units of the prior at scale 1.
    fn conditional_single_column(&self, gram: &Gram<'_>, index: usize) -> (f64, f64) {
        let alone = &gram.scores[index];
        let first = gram.first[index] - self.offset;
        let sd = gram.candidates[index].prior[(0, 0)];
        let information = (alone.information[(0, 0)] - self.eliminated[first]).max(0.0);
        (
            (alone.score[0] - self.explained[first]) * sd,
            information * sd * sd,
        )
    }
}

/// Log evidence of a candidate with one column at one of its scales, including the prior of the scale, for a score in
/// units of the prior at scale 1.
fn single_column_evidence(
    candidate: &Candidate,
    scale: usize,
    score: f64,
    information: f64,
) -> f64 {
    let (sd, weight) = candidate.scales[scale];
    let spread = 1.0 + information * sd * sd;
    let mut value = of_one(score * sd, information * sd * sd) + weight;
    if candidate.is_positive {
        value += log_positive(-score * sd * sd / spread, sd * sd / spread);
    }
    value
}

impl CandidateScore {
    /// Converts to units of the prior at scale 1.
    pub(super) fn in_prior_units(&self, candidate: &Candidate) -> Self {
        Self {
            score: candidate.prior.tr_mul(&self.score),
            information: candidate.prior.tr_mul(&self.information) * &candidate.prior,
        }
    }

    /// In units of the prior at scale 1: log evidence at each scale, including the prior of the scale.
    pub(super) fn at_scales(&self, candidate: &Candidate) -> Vec<(f64, usize)> {
        let value = |scale: usize| {
            if self.score.len() == 1 {
                let information = self.information[(0, 0)].max(0.0);
                return Some(single_column_evidence(
                    candidate,
                    scale,
                    self.score[0],
                    information,
                ));
            }
            Some(self.value(candidate, scale)?.1)
        };
        (0..candidate.scales.len())
            .filter_map(|scale| Some((value(scale)?, scale)))
            .collect()
    }

    /// In units of the prior at scale 1: half of the chi-square gain at a scale, and the log evidence.
    fn value(&self, candidate: &Candidate, scale: usize) -> Option<(f64, f64)> {
        let (size, weight) = candidate.scales[scale];
        let score = &self.score * size;
        let evidence = Evidence::new(score, &self.information * (size * size))?;
        Some((evidence.gain(), evidence.log() + weight))
    }
}

/// `to := to + weight * from`.
fn axpy(weight: f64, from: &[f64], to: &mut [f64]) {
    for (to, from) in to.iter_mut().zip(from) {
        *to += weight * from;
    }
}

/// `columns := columns L^-T`, column by column because the columns are long and few.
fn divide_by_factor(columns: &mut DMatrix<f64>, l: &DMatrix<f64>) {
    for k in 0..columns.ncols() {
        for j in 0..k {
            let (from, mut to) = columns.columns_range_pair_mut(j, k);
            to.axpy(-l[(k, j)], &from, 1.0);
        }
        columns.column_mut(k).unscale_mut(l[(k, k)]);
    }
}

/// Largest log evidence over the scales of a candidate, including the prior of the scale, for a score in units of the
/// prior at scale 1. `None` if it is clearly below `least`.
pub(super) fn best_scale(
    candidate: &Candidate,
    score: &CandidateScore,
    least: f64,
) -> Option<(f64, usize)> {
    let (gain, probe) = score.value(candidate, candidate.scales.len() / 2)?;
    if gain < STRONG_GAIN && probe + candidate.log_odds < least - MAX_DEFICIT {
        return None;
    }
    let values = score.at_scales(candidate).into_iter();
    values.max_by(|a, b| a.0.total_cmp(&b.0))
}

/// Increase of the log prior odds of a candidate because the set has the same effect on other cables.
fn joint_odds_bonus(gram: &Gram<'_>, members: &[Member], index: usize) -> f64 {
    let candidate = &gram.candidates[index];
    if !candidate.is_single() {
        return 0.0;
    }
    let candidates = members.iter().map(|m| &gram.candidates[m.0]);
    let same = candidates.filter(|c| c.is_single() && std::ptr::eq(c.effect(), candidate.effect()));
    let count = same.count();
    let log = |count| log_joint_odds_ratio(candidate, count, gram.cables);
    log(count + 1) - log(count)
}

//! The evidence of a set of causes in closed form.
//!
//! With the Gram matrix `G` and the score `b` of the columns of a set, in units of their prior, the logarithm of the
//! evidence over that of no cause is `1/2 b^T (1 + G)^-1 b - 1/2 log det(1 + G)`. The determinant is the price of a
//! parameter. A parameter that is not negative has a normal prior cut at zero, which adds the logarithm of twice the
//! probability that it is positive given the data. The size of a prior is one of several scales.

use nalgebra::{Cholesky, DMatrix, DVector};

use super::candidates::Candidate;
use super::gram::{Gram, Own};
use crate::statistics::log_normal_cdf;

/// A cause in a set: number of its candidate and place of its scale.
pub(super) type Member = (usize, usize);

/// A set of causes with its evidence, ready to be extended.
pub(super) struct System {
    pub members: Vec<Member>,
    /// `L^-1 F^T R` with the rows `R` of the set: one row per parameter, one column per column of the catalogue by which it
    /// may be extended.
    rows: DMatrix<f64>,
    /// Number of the first of these columns in the catalogue.
    offset: usize,
    /// `L^-1 b`.
    score: DVector<f64>,
    /// Logarithm of the evidence and the prior of the set.
    pub log_posterior: f64,
    /// Estimates of the columns' parameters, member after member.
    pub estimate: DVector<f64>,
    /// Their covariance.
    pub covariance: DMatrix<f64>,
}

fn scaled_prior(candidate: &Candidate, scale: usize) -> DMatrix<f64> {
    &candidate.prior * candidate.scales[scale].0
}

impl System {
    /// The set with these members, ready to be extended by any candidate.
    pub fn extensible(gram: &mut Gram<'_>, members: &[Member]) -> Self {
        let all = 0..*gram.first.last().unwrap_or(&0);
        Self::with_columns(gram, members, all)
    }

    /// The set with these members, which may be extended by one candidate.
    pub fn extensible_by(gram: &mut Gram<'_>, members: &[Member], candidate: usize) -> Self {
        let own = gram.first[candidate]..gram.first[candidate + 1];
        Self::with_columns(gram, members, own)
    }

    /// The set with these members.
    pub fn new(gram: &mut Gram<'_>, members: &[Member]) -> Self {
        Self::with_columns(gram, members, 0..0)
    }

    fn with_columns(
        gram: &mut Gram<'_>,
        members: &[Member],
        extension: std::ops::Range<usize>,
    ) -> Self {
        let width: usize = members
            .iter()
            .map(|m| gram.candidates[m.0].columns.len())
            .sum();
        let mut factor = DMatrix::zeros(width, width);
        let own: Vec<usize> = members
            .iter()
            .flat_map(|m| gram.first[m.0]..gram.first[m.0 + 1])
            .collect();
        let mut rows = DMatrix::zeros(width, extension.len());
        let mut among = DMatrix::zeros(width, width);
        let mut score = DVector::zeros(width);
        let mut at = 0;
        let mut log_prior = 0.0;
        for (index, scale) in members {
            let candidate = &gram.candidates[*index];
            let count = candidate.columns.len();
            let prior = scaled_prior(candidate, *scale);
            factor.view_mut((at, at), (count, count)).copy_from(&prior);
            log_prior += candidate.log_odds + candidate.scales[*scale].1;
            score.rows_mut(at, count).copy_from(&gram.own[*index].score);
            for k in 0..count {
                let row = gram.row(gram.first[*index] + k);
                rows.row_mut(at + k)
                    .copy_from_slice(&row[extension.clone()]);
                for (to, column) in own.iter().enumerate() {
                    among[(at + k, to)] = row[*column];
                }
            }
            at += count;
        }
        let rows = factor.transpose() * &rows;
        let score = factor.tr_mul(&score);
        let mut matrix = DMatrix::identity(width, width);
        matrix += factor.tr_mul(&among) * &factor;
        let matrix = (&matrix + matrix.transpose()) * 0.5;
        let cholesky = Cholesky::new(matrix).unwrap_or_else(|| {
            // Rounding of a nearly singular matrix: one plus a positive semidefinite one.
            Cholesky::pack_dirty(DMatrix::identity(width, width))
        });
        let mut whitened = rows;
        cholesky.l_dirty().solve_lower_triangular_mut(&mut whitened);
        let mut half = score.clone();
        cholesky.l_dirty().solve_lower_triangular_mut(&mut half);
        let log_determinant = 2.0 * cholesky.l_dirty().diagonal().map(f64::ln).sum();
        let estimate = &factor * cholesky.solve(&-&score);
        let covariance = &factor * cholesky.solve(&factor.transpose());
        let mut system = Self {
            members: members.to_vec(),
            rows: whitened,
            offset: extension.start,
            log_posterior: 0.5 * (half.norm_squared() - log_determinant) + log_prior,
            score: half,
            estimate,
            covariance,
        };
        system.log_posterior += system.log_signs(gram.candidates);
        system
    }

    /// What the signs of the parameters add.
    fn log_signs(&self, candidates: &[Candidate]) -> f64 {
        let mut at = 0;
        let mut sum = 0.0;
        for (index, _) in &self.members {
            if candidates[*index].is_positive {
                sum += log_positive(self.estimate[at], self.covariance[(at, at)]);
            }
            at += candidates[*index].columns.len();
        }
        sum
    }

    /// First parameter of each member.
    pub fn parameters(&self, candidates: &[Candidate]) -> Vec<std::ops::Range<usize>> {
        let mut at = 0;
        let range = |(index, _): &Member| {
            let first = at;
            at += candidates[*index].columns.len();
            first..at
        };
        self.members.iter().map(range).collect()
    }

    /// By how much the logarithm of the posterior rises with a further candidate, and its best scale; nothing where that is
    /// clearly below `least`.
    pub fn gain(&self, gram: &Gram<'_>, index: usize, least: f64) -> Option<(f64, usize)> {
        let candidate = &gram.candidates[index];
        let (first, count) = (gram.first[index], candidate.columns.len());
        let own = &gram.own[index];
        let log_odds = candidate.log_odds;
        if count == 1 {
            let rows = self.rows.column(first - self.offset);
            let information = (own.information[(0, 0)] - rows.norm_squared()).max(0.0);
            let score = own.score[0] - rows.dot(&self.score);
            let best = |(scale, (size, weight)): (usize, &(f64, f64))| {
                let sd = candidate.prior[(0, 0)] * size;
                let spread = 1.0 + information * sd * sd;
                let mut value = 0.5 * ((score * sd).powi(2) / spread - spread.ln()) + weight;
                if candidate.is_positive {
                    value += log_positive(-score * sd * sd / spread, sd * sd / spread);
                }
                (value + log_odds, scale)
            };
            let all = candidate.scales.iter().enumerate().map(best);
            let found = all.max_by(|a, b| a.0.total_cmp(&b.0))?;
            return (found.0 >= least).then_some(found);
        }
        let rows = self.rows.columns(first - self.offset, count);
        let conditional = Own {
            score: &own.score - rows.tr_mul(&self.score),
            information: &own.information - rows.tr_mul(&rows),
        };
        best_scale(candidate, &conditional, least).map(|(value, scale)| (value + log_odds, scale))
    }
}

/// The largest evidence over the scales of a candidate, their probabilities included.
fn best_scale(candidate: &Candidate, own: &Own, least: f64) -> Option<(f64, usize)> {
    let score = candidate.prior.tr_mul(&own.score);
    let information = candidate.prior.tr_mul(&own.information) * &candidate.prior;
    // Half of the chi-square gained less the penalty, and the evidence.
    let value = |scale: usize| -> Option<(f64, f64)> {
        let (size, weight) = candidate.scales[scale];
        let mut matrix = &information * (size * size);
        for k in 0..matrix.nrows() {
            matrix[(k, k)] += 1.0;
        }
        let factor = matrix.cholesky()?;
        let mut half = &score * size;
        factor.l_dirty().solve_lower_triangular_mut(&mut half);
        let log_determinant = 2.0 * factor.l_dirty().diagonal().map(f64::ln).sum();
        let gain = 0.5 * half.norm_squared();
        Some((gain, gain - 0.5 * log_determinant + weight))
    };
    let (gain, probe) = value(candidate.scales.len() / 2)?;
    if gain < STRONG && probe + candidate.log_odds < least - PROBED {
        return None;
    }
    let all = (0..candidate.scales.len()).filter_map(|k| Some((value(k)?.1, k)));
    all.max_by(|a, b| a.0.total_cmp(&b.0))
}

/// How far below what is looked for a candidate is at its middle scale where other scales are not tried, unless it gains
/// so much there that the scale may matter more.
const PROBED: f64 = 12.0;
const STRONG: f64 = 20.0;

/// Logarithm of twice the probability that a normal variable is positive.
fn log_positive(mean: f64, variance: f64) -> f64 {
    if variance <= 0.0 {
        return 0.0;
    }
    std::f64::consts::LN_2 + log_normal_cdf(mean / variance.sqrt())
}

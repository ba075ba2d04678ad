//! The covariance of residuals under a correct model, and score tests of groups of them.
//!
//! Let `e` be the noise of all rows of a linearisation in their standard deviations, with covariance `I`. Least squares
//! leaves the residuals `r = M e` with the projector
//!
//! `M = blockdiag(Q_j Q_j^T) - V V^T`,
//!
//! with `Q_j` (`n_j x q_j`) an orthonormal basis of the part of pose `j`'s `n_j` rows that the pose cannot absorb, 1
//! for rows of no pose, and `V` (`N x rank`) an orthonormal basis of what the common parameters absorb. `M` is
//! therefore also the covariance of `r`, its diagonal has the redundancies and its trace is the number of degrees of
//! freedom (Baarda 1968). `M` is never formed, because its size is the number of readings squared.

use nalgebra::{Cholesky, DMatrix, DVector, SymmetricEigen};

use super::budget::{PROJECTOR_THRESHOLD, UNDETERMINED};
use super::dense::divide_by_lower;
use super::reading_id::ReadingId;
use crate::estimation::{LinearRow, Linearisation};

/// The rows of one pose.
#[derive(Debug, Clone)]
struct Block {
    rows: std::ops::Range<usize>,
    /// `Q^T`, one column per row.
    remainder: DMatrix<f64>,
}

/// Residuals and their covariance.
#[derive(Debug, Clone)]
pub(crate) struct ResidualSpace {
    /// The reading behind each row.
    pub readings: Vec<Option<ReadingId>>,
    /// Row of the measurements for each row of the linearisation; `None` for priors.
    pub measured: Vec<Option<usize>>,
    /// The residuals in standard deviations.
    pub residual: DVector<f64>,
    blocks: Vec<Block>,
    /// `V^T`, one column per row.
    fitted: DMatrix<f64>,
}

/// Sums over classes of rows.
#[derive(Debug, Clone)]
pub(crate) struct ClassSums {
    /// Number of rows.
    pub counts: Vec<usize>,
    /// `r_a^T r_a`.
    pub squares: Vec<f64>,
    /// `tr M_aa`, the expectation of the squares.
    pub traces: Vec<f64>,
    /// `tr(M_ab M_ba)`: half the covariance of the squares.
    pub information: DMatrix<f64>,
}

impl ClassSums {
    /// Factor and degrees of freedom of the scaled chi-square distribution with the same mean `tr M` and variance
    /// `2 tr M^2` as the sum of squares of a class (Satterthwaite 1946). `None` for residuals that are always zero.
    pub fn scaled_chi_square(&self, class: usize) -> Option<(f64, f64)> {
        let (mean, half_variance) = (self.traces[class], self.information[(class, class)]);
        let seen = mean > 1e-6 && half_variance > 0.0;
        seen.then(|| (half_variance / mean, mean * mean / half_variance))
    }
}

impl ResidualSpace {
    /// The residuals of a linearisation.
    pub fn new(linear: &Linearisation) -> Self {
        let of = |row: &LinearRow| ReadingId::of(row, linear);
        Self {
            readings: linear.rows.iter().map(of).collect(),
            measured: linear.rows.iter().map(|row| row.row).collect(),
            residual: linear.residual.clone(),
            blocks: linear
                .poses
                .iter()
                .map(|pose| Block {
                    rows: pose.rows.clone(),
                    remainder: range_basis(&pose.remainder),
                })
                .collect(),
            fitted: row_basis(&linear.design.transpose()),
        }
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.residual.len()
    }

    /// Rows that belong to no pose: those of the home pose and the priors.
    fn loose_rows(&self) -> std::ops::Range<usize> {
        self.blocks.last().map_or(0, |block| block.rows.end)..self.rows()
    }

    /// Redundancy of each row, the diagonal of `M`: the share of an error that shows in its own residual.
    pub fn redundancy(&self) -> Vec<f64> {
        let mut redundancy = vec![1.0; self.rows()];
        for block in &self.blocks {
            for (row, basis) in block.rows.clone().zip(block.remainder.column_iter()) {
                redundancy[row] = basis.norm_squared();
            }
        }
        for (redundancy, fitted) in redundancy.iter_mut().zip(self.fitted.column_iter()) {
            *redundancy -= fitted.norm_squared();
        }
        redundancy
    }

    /// Sums over classes of rows, where `class_of` has the class of each row as an index below `count`.
    pub fn class_sums(&self, class_of: &[Option<usize>], count: usize) -> ClassSums {
        let mut sums = ClassSums {
            counts: vec![0; count],
            squares: vec![0.0; count],
            traces: vec![0.0; count],
            information: DMatrix::zeros(count, count),
        };
        for (row, redundancy) in self.redundancy().into_iter().enumerate() {
            if let Some(class) = class_of[row] {
                sums.counts[class] += 1;
                sums.squares[class] += self.residual[row] * self.residual[row];
                sums.traces[class] += redundancy;
            }
        }
        self.add_local_information(class_of, &mut sums.information);
        self.add_common_information(class_of, &mut sums.information);
        sums
    }

    /// Adds `sum_j ||B_ab||^2 - 2 tr(V_a^T B_ab V_b)` with the blocks `B = Q Q^T` of the poses.
    fn add_local_information(&self, class_of: &[Option<usize>], information: &mut DMatrix<f64>) {
        for block in &self.blocks {
            let alone = block.remainder.transpose() * &block.remainder;
            let fitted = self.fitted.columns(block.rows.start, block.rows.len());
            let common = fitted.transpose() * fitted;
            for (i, a) in block.rows.clone().enumerate() {
                for (k, b) in block.rows.clone().enumerate() {
                    if let (Some(a), Some(b)) = (class_of[a], class_of[b]) {
                        let covariance = alone[(i, k)];
                        information[(a, b)] += covariance * (covariance - 2.0 * common[(i, k)]);
                    }
                }
            }
        }
        for row in self.loose_rows() {
            if let Some(a) = class_of[row] {
                information[(a, a)] += 1.0 - 2.0 * self.fitted.column(row).norm_squared();
            }
        }
    }

    /// Adds `tr(V_a^T V_a V_b^T V_b)`.
    fn add_common_information(&self, class_of: &[Option<usize>], information: &mut DMatrix<f64>) {
        let products: Vec<DMatrix<f64>> = (0..information.nrows())
            .map(|class| {
                let rows: Vec<usize> = (0..self.rows())
                    .filter(|row| class_of[*row] == Some(class))
                    .collect();
                let fitted = self.fitted.select_columns(&rows);
                &fitted * fitted.transpose()
            })
            .collect();
        for (a, first) in products.iter().enumerate() {
            for (b, second) in products.iter().enumerate() {
                information[(a, b)] += first.dot(second);
            }
        }
    }

    /// Combines the rows `rows`, in ascending order, to a group.
    pub fn group(&self, rows: Vec<usize>) -> RowGroup {
        let mut parts = Vec::new();
        let mut first = 0;
        for block in &self.blocks {
            let inside = rows[first..].iter();
            let count = inside.take_while(|row| **row < block.rows.end).count();
            if count > 0 {
                let local = rows[first..first + count].iter();
                let local: Vec<usize> = local.map(|row| row - block.rows.start).collect();
                let basis = block.remainder.select_columns(&local);
                parts.push(GroupPart {
                    rows: first..first + count,
                    covariance: basis.tr_mul(&basis),
                });
            }
            first += count;
        }
        RowGroup {
            residual: self.residual.select_rows(&rows),
            fitted: self.fitted.select_columns(&rows),
            rows,
            parts,
        }
    }

    /// The residuals and their covariance if the noise of each row were larger by its factor: the linearised problem,
    /// weighted accordingly and solved again. With `D = diag(factors)`, the basis `Q` of a pose becomes `D Q K^-T` with
    /// `K K^T = Q^T D^2 Q`, and its residuals and `V` are mapped by `D Q (Q^T D^2 Q)^-1 Q^T`.
    ///
    /// # Panics
    /// If a factor is not a positive number.
    pub fn rescaled(&self, factors: &[f64]) -> Self {
        let mut fitted = self.fitted.clone();
        let mut residual = self.residual.clone();
        let mut blocks = Vec::with_capacity(self.blocks.len());
        for block in &self.blocks {
            let (start, count) = (block.rows.start, block.rows.len());
            let mut stretched = block.remainder.clone();
            for (mut column, factor) in stretched.column_iter_mut().zip(&factors[start..]) {
                column *= *factor;
            }
            let weight = Cholesky::new(&stretched * stretched.transpose());
            let weight = weight.expect("a basis stretched by positive factors is one");
            let solve = |m: &DMatrix<f64>| weight.l_dirty().solve_lower_triangular(m);
            let (Some(inner), Some(basis)) = (solve(&block.remainder), solve(&stretched)) else {
                unreachable!("the factor of a positive definite matrix is regular");
            };
            let new = basis.tr_mul(&(&inner * self.residual.rows(start, count)));
            residual.rows_mut(start, count).copy_from(&new);
            let new = (self.fitted.columns(start, count) * inner.transpose()) * &basis;
            fitted.columns_mut(start, count).copy_from(&new);
            blocks.push(Block {
                rows: block.rows.clone(),
                remainder: basis,
            });
        }
        for row in self.loose_rows() {
            residual[row] /= factors[row];
            fitted.column_mut(row).unscale_mut(factors[row]);
        }
        let fitted = orthonormalised(fitted);
        residual -= fitted.tr_mul(&(&fitted * &residual));
        Self {
            readings: self.readings.clone(),
            measured: self.measured.clone(),
            residual,
            blocks,
            fitted,
        }
    }
}

/// The rows of a group that belong to one pose.
#[derive(Debug, Clone)]
struct GroupPart {
    /// Range of the rows within the group.
    rows: std::ops::Range<usize>,
    /// `Q Q^T`.
    covariance: DMatrix<f64>,
}

/// Some rows with the covariance of their residuals.
#[derive(Debug, Clone)]
pub(crate) struct RowGroup {
    /// The rows, ascending.
    pub rows: Vec<usize>,
    /// Their residuals.
    pub residual: DVector<f64>,
    parts: Vec<GroupPart>,
    /// `V_g^T`.
    fitted: DMatrix<f64>,
}

/// Score of row functions, and its distribution without an error of that form.
#[derive(Debug, Clone)]
pub(crate) struct Score {
    /// `Phi^T r_g`.
    pub score: DVector<f64>,
    /// `Phi^T M_gg Phi`, its covariance.
    pub information: DMatrix<f64>,
    /// `M_gg Phi`.
    pub projected: DMatrix<f64>,
}

impl RowGroup {
    /// Score and information of row functions (`|g| x k`).
    pub fn score(&self, functions: &DMatrix<f64>) -> Score {
        let projected = self.project(functions);
        Score {
            score: functions.tr_mul(&self.residual),
            information: functions.tr_mul(&projected),
            projected,
        }
    }

    /// `M_gg Phi`.
    fn project(&self, functions: &DMatrix<f64>) -> DMatrix<f64> {
        let mut projected = functions.clone();
        for part in &self.parts {
            for k in 0..functions.ncols() {
                let from = functions.view((part.rows.start, k), (part.rows.len(), 1));
                for (row, covariance) in part.rows.clone().zip(part.covariance.column_iter()) {
                    projected[(row, k)] = covariance.dot(&from);
                }
            }
        }
        projected -= self.fitted.tr_mul(&(&self.fitted * functions));
        projected
    }
}

/// Orthonormal basis of the range of `C`, transposed; `C C^T` must be a projector.
pub(super) fn range_basis(c: &DMatrix<f64>) -> DMatrix<f64> {
    if c.is_empty() {
        return DMatrix::zeros(0, c.nrows());
    }
    let eigen = SymmetricEigen::new(c.tr_mul(c));
    let kept: Vec<usize> = (0..eigen.eigenvalues.len())
        .filter(|k| eigen.eigenvalues[*k] > PROJECTOR_THRESHOLD)
        .collect();
    let directions = eigen.eigenvectors.select_columns(&kept);
    directions.transpose() * c.transpose()
}

/// Orthonormal basis of the row space of a matrix with independent rows.
fn orthonormalised(mut wide: DMatrix<f64>) -> DMatrix<f64> {
    match Cholesky::new(&wide * wide.transpose()) {
        Some(factor) => {
            divide_by_lower(factor.l_dirty(), &mut wide);
            wide
        }
        None => row_basis(&wide),
    }
}

/// Orthonormal basis of the row space of `wide` (`n x N`, one row per parameter), with at most `n` rows.
fn row_basis(wide: &DMatrix<f64>) -> DMatrix<f64> {
    if wide.is_empty() {
        return DMatrix::zeros(0, wide.ncols());
    }
    let mut scaled = wide.clone();
    for mut row in scaled.row_iter_mut() {
        let norm = row.norm();
        if norm > 0.0 {
            row /= norm;
        }
    }
    let eigen = SymmetricEigen::new(&scaled * scaled.transpose());
    let limit = UNDETERMINED * eigen.eigenvalues.iter().copied().fold(0.0, f64::max);
    let kept: Vec<usize> = (0..eigen.eigenvalues.len())
        .filter(|k| eigen.eigenvalues[*k] > limit)
        .collect();
    let mut directions = eigen.eigenvectors.select_columns(&kept);
    for (mut direction, k) in directions.column_iter_mut().zip(&kept) {
        direction /= eigen.eigenvalues[*k].sqrt();
    }
    directions.transpose() * scaled
}

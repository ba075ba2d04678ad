//! The readings as condition equations, with poses and latent tensions eliminated.
//!
//! With `Q_j` an orthonormal basis of the part of pose `j`'s rows that the pose cannot absorb, the conditions are
//! `y_j = Q_j^T r_j`, their derivatives `Q_j^T A_j`, and their noise has the covariance `Q_j^T D_j Q_j` with the ratios
//! `D_j` of the readings' variances to those described. A change of the noise therefore needs no new elimination.
//! Readings that belong to no pose and priors are conditions themselves. (Mikhail and Ackermann, Observations and Least
//! Squares, 1976, chapter 7.)

use std::collections::BTreeMap;
use std::ops::Range;

use nalgebra::{Cholesky, DMatrix, DVector, SymmetricEigen};

use super::budget::PROJECTOR_THRESHOLD;
use super::reading_id::ReadingId;
use crate::estimation::{Linearisation, ParameterId, RowKind};

/// The conditions of one pose, or of one row that belongs to no pose.
#[derive(Debug, Clone)]
pub(super) struct Block {
    /// Range of the conditions.
    pub conditions: Range<usize>,
    /// Range of the rows of the linearisation.
    rows: Range<usize>,
    /// `Q^T`, one column per row.
    basis: DMatrix<f64>,
    /// Class of each row; `None` for rows that are not readings.
    classes: Vec<Option<usize>>,
}

/// All condition equations of a linearisation.
#[derive(Debug, Clone)]
pub(super) struct Conditions {
    pub blocks: Vec<Block>,
    /// Number of poses, whose blocks come first.
    pub poses: usize,
    /// Number of conditions.
    pub count: usize,
    /// Classes of readings; each has its own variance.
    pub classes: Vec<ReadingId>,
}

/// Noise of all conditions for given variances of the classes.
pub(super) struct Noise<'c> {
    conditions: &'c Conditions,
    /// Variance of each class over the described one.
    pub variance: Vec<f64>,
    /// Inverse Cholesky factor `L^-1` of each block; `None` where the noise is as described.
    factors: Vec<Option<DMatrix<f64>>>,
    pub log_determinant: f64,
}

impl Conditions {
    /// The conditions of a linearisation. Priors of parameters that do not satisfy `is_estimated` are left out.
    pub fn new(linear: &Linearisation, is_estimated: impl Fn(&ParameterId) -> bool) -> Self {
        let ids: Vec<_> = linear
            .rows
            .iter()
            .map(|row| ReadingId::of(row, linear))
            .collect();
        let mut index: BTreeMap<ReadingId, usize> =
            ids.iter().flatten().map(|id| (*id, 0)).collect();
        for (place, index) in index.values_mut().enumerate() {
            *index = place;
        }
        let class = |row: usize| ids[row].as_ref().map(|id| index[id]);
        let mut conditions = Self {
            blocks: Vec::new(),
            poses: linear.poses.len(),
            count: 0,
            classes: index.keys().copied().collect(),
        };
        for pose in &linear.poses {
            let classes = pose.rows.clone().map(class).collect();
            conditions.push(pose.rows.clone(), range_basis(&pose.remainder), classes);
        }
        let first = linear.poses.last().map_or(0, |pose| pose.rows.end);
        for row in first..linear.rows.len() {
            if let RowKind::Prior(k) = linear.rows[row].kind
                && !is_estimated(&linear.parameters[k].id)
            {
                continue;
            }
            conditions.push(row..row + 1, DMatrix::identity(1, 1), vec![class(row)]);
        }
        conditions
    }

    fn push(&mut self, rows: Range<usize>, basis: DMatrix<f64>, classes: Vec<Option<usize>>) {
        let first = self.count;
        self.count += basis.nrows();
        self.blocks.push(Block {
            conditions: first..self.count,
            rows,
            basis,
            classes,
        });
    }

    /// Conditions for functions of the rows, one function per column.
    pub fn project_rows(&self, rows: &DMatrix<f64>) -> DMatrix<f64> {
        let mut conditions = DMatrix::zeros(self.count, rows.ncols());
        for block in &self.blocks {
            let part = rows.rows(block.rows.start, block.rows.len());
            let mut to = conditions.rows_mut(block.conditions.start, block.conditions.len());
            to.gemm(1.0, &block.basis, &part, 0.0);
        }
        conditions
    }

    /// Conditions for functions of the readings of one class, given one value per pose. Of several readings of the
    /// class at a pose the first counts.
    pub fn project_class(&self, class: usize, functions: &DMatrix<f64>) -> DMatrix<f64> {
        let mut conditions = DMatrix::zeros(self.count, functions.ncols());
        for (pose, block) in self.blocks[..self.poses].iter().enumerate() {
            let Some(row) = block.classes.iter().position(|c| *c == Some(class)) else {
                continue;
            };
            let mut to = conditions.rows_mut(block.conditions.start, block.conditions.len());
            to.ger(
                1.0,
                &block.basis.column(row),
                &functions.row(pose).transpose(),
                0.0,
            );
        }
        conditions
    }

    /// Poses at which a class has a reading.
    pub fn poses_of(&self, class: usize) -> Vec<usize> {
        let has = |pose: &usize| self.blocks[*pose].classes.contains(&Some(class));
        (0..self.poses).filter(has).collect()
    }

    /// `x^T C x` for each column, where `C` is the covariance of the conditions for given variances of the classes.
    pub fn variances(&self, variance: &[f64], columns: &DMatrix<f64>) -> Vec<f64> {
        let mut sums = vec![0.0; columns.ncols()];
        for block in &self.blocks {
            let part = columns.rows(block.conditions.start, block.conditions.len());
            let rows = block.basis.tr_mul(&part);
            for (sum, column) in sums.iter_mut().zip(rows.column_iter()) {
                for (value, class) in column.iter().zip(&block.classes) {
                    *sum += class.map_or(1.0, |k| variance[k]) * value * value;
                }
            }
        }
        sums
    }

    /// The noise for given variances of the classes.
    pub fn noise(&self, variance: &[f64]) -> Noise<'_> {
        let mut noise = Noise {
            conditions: self,
            variance: variance.to_vec(),
            factors: Vec::with_capacity(self.blocks.len()),
            log_determinant: 0.0,
        };
        for block in &self.blocks {
            let variance_of = |class: &Option<usize>| class.map_or(1.0, |k| variance[k]);
            let row: Vec<f64> = block.classes.iter().map(variance_of).collect();
            if row.iter().all(|v| *v == 1.0) {
                noise.factors.push(None);
                continue;
            }
            let mut scaled = block.basis.clone();
            for (mut column, v) in scaled.column_iter_mut().zip(&row) {
                column *= *v;
            }
            let factor = Cholesky::new(&scaled * block.basis.transpose());
            noise.factors.push(factor.map(|factor| {
                let diagonal = factor.l_dirty().diagonal();
                noise.log_determinant += 2.0 * diagonal.map(f64::ln).sum();
                let mut inverse = DMatrix::identity(diagonal.len(), diagonal.len());
                factor.l_dirty().solve_lower_triangular_mut(&mut inverse);
                inverse
            }));
        }
        noise
    }
}

/// Concatenates matrices with the same number of rows.
pub(super) fn concatenate_columns(parts: &[&DMatrix<f64>]) -> DMatrix<f64> {
    let rows = parts.first().map_or(0, |part| part.nrows());
    let width = parts.iter().map(|part| part.ncols()).sum();
    let mut joined = DMatrix::zeros(rows, width);
    let mut first = 0;
    for part in parts {
        joined.columns_mut(first, part.ncols()).copy_from(part);
        first += part.ncols();
    }
    joined
}

impl Noise<'_> {
    /// Whitens columns: `L^-1 x`, where `L L^T` is the covariance of the conditions.
    pub fn whiten(&self, x: &mut DMatrix<f64>) {
        for (block, factor) in self.conditions.blocks.iter().zip(&self.factors) {
            if let Some(factor) = factor {
                let mut part = x.rows_mut(block.conditions.start, block.conditions.len());
                let whitened = factor * &part;
                part.copy_from(&whitened);
            }
        }
    }

    /// `L^-1 Q^T D^(1/2)` for each block, an orthonormal basis of the rows of its readings in units of this noise, with the
    /// ranges of its rows and conditions.
    pub fn bases(&self) -> impl Iterator<Item = (Range<usize>, Range<usize>, DMatrix<f64>)> {
        let blocks = self.conditions.blocks.iter().zip(&self.factors);
        blocks.map(|(block, factor)| {
            let mut basis = block.basis.clone();
            if let Some(factor) = factor {
                for (mut column, class) in basis.column_iter_mut().zip(&block.classes) {
                    column *= class.map_or(1.0, |k| self.variance[k].sqrt());
                }
                basis = factor * basis;
            }
            (block.rows.clone(), block.conditions.clone(), basis)
        })
    }

    /// Whitened conditions of a unit error in the readings of some classes, for each pose: index of the first
    /// condition, and values.
    pub fn unit_errors(&self, classes: &[usize]) -> Vec<(usize, DVector<f64>)> {
        let poses = &self.conditions.blocks[..self.conditions.poses];
        let unit_error = |(block, factor): (&Block, &Option<DMatrix<f64>>)| {
            let mut error = DVector::zeros(block.conditions.len());
            for class in classes {
                if let Some(row) = block.classes.iter().position(|c| c == &Some(*class)) {
                    error += block.basis.column(row);
                }
            }
            let error = factor
                .as_ref()
                .map_or(error.clone(), |factor| factor * error);
            (block.conditions.start, error)
        };
        poses.iter().zip(&self.factors).map(unit_error).collect()
    }

    /// For each class the sum of squares of the estimated errors, in units of the described noise, and its expectation
    /// divided by the variance: `sum (v w.p)^2` and `v sum w^T P w` over its rows, with `w` the column of `Q^T` of a
    /// row, the weighted residual `p = L^-T r` and `P = L^-T (1 - U U^T) L^-1`; `eliminated` is `U^T`.
    pub fn class_sums(&self, residual: &DVector<f64>, eliminated: &DMatrix<f64>) -> Vec<[f64; 2]> {
        let mut sums = vec![[0.0; 2]; self.conditions.classes.len()];
        for (block, factor) in self.conditions.blocks.iter().zip(&self.factors) {
            if block.classes.iter().all(Option::is_none) {
                continue;
            }
            let rows = match factor {
                Some(factor) => factor * &block.basis,
                None => block.basis.clone(),
            };
            let (first, count) = (block.conditions.start, block.conditions.len());
            let error = rows.tr_mul(&residual.rows(first, count));
            let eliminated = eliminated.columns(first, count) * &rows;
            for (row, class) in block.classes.iter().enumerate() {
                if let Some(class) = class {
                    let v = self.variance[*class];
                    let redundancy =
                        rows.column(row).norm_squared() - eliminated.column(row).norm_squared();
                    sums[*class][0] += (v * error[row]).powi(2);
                    sums[*class][1] += v * redundancy;
                }
            }
        }
        sums
    }
}

/// Orthonormal basis of the range of `C`, transposed; `C C^T` must be a projector.
fn range_basis(c: &DMatrix<f64>) -> DMatrix<f64> {
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

/// Whether a parameter is in the model whatever the set of causes: not one of a candidate cause or of a deviation, which have
/// priors of their own there.
pub(super) fn is_fixed(id: &ParameterId, model_effects: usize) -> bool {
    match id {
        ParameterId::Effect { effect, .. } => *effect < model_effects,
        ParameterId::Deviation { .. } => false,
        _ => true,
    }
}

/// The columns of the parameters that satisfy a condition.
pub(super) fn columns_of(
    linear: &Linearisation,
    condition: impl Fn(&ParameterId) -> bool,
) -> DMatrix<f64> {
    let indices = 0..linear.parameters.len();
    let chosen: Vec<usize> = indices
        .filter(|k| condition(&linear.parameters[*k].id))
        .collect();
    linear.design.select_columns(&chosen)
}

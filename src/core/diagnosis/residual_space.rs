//! The covariance of residuals under a correct model, and score tests of groups of them.
//!
//! Let `e` be the noise of all rows of a linearisation in their standard deviations, with covariance `I`. Least squares
//! leaves the residuals `r = M e` with the projector
//!
//! `M = blockdiag(Q_j Q_j^T) - V V^T`,
//!
//! with the bases `Q_j` (`n_j x q_j`) of the [`Conditions`], 1 for rows of no pose, and `V` (`N x rank`) an orthonormal
//! basis of what the common parameters absorb. `M` is therefore also the covariance of `r`, its diagonal has the
//! redundancies and its trace is the number of degrees of freedom (Baarda 1968). `M` is never formed, because its size
//! is the number of readings squared.

use std::rc::Rc;

use nalgebra::{DMatrix, DVector};

use super::conditions::Conditions;
use super::projector::Projector;
use super::reading_id::ReadingId;
use crate::estimation::{LinearRow, Linearisation};

/// The conditions of a fit, with the derivatives by all of its parameters.
#[derive(Debug)]
struct FitConditions {
    conditions: Conditions,
    /// One column per parameter.
    design: DMatrix<f64>,
    residual: DVector<f64>,
}

/// The rows of one pose, or one row that belongs to no pose.
#[derive(Debug, Clone)]
struct Block {
    rows: std::ops::Range<usize>,
    /// `Q^T`, one column per row.
    basis: DMatrix<f64>,
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
    fit: Rc<FitConditions>,
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
    /// The residuals of a linearisation, in the noise as described.
    pub fn new(linear: &Linearisation) -> Self {
        let conditions = Conditions::new(linear, |_| true);
        let residual = DMatrix::from_column_slice(linear.rows.len(), 1, linear.residual.as_slice());
        let described = vec![1.0; conditions.classes.len()];
        let fit = Rc::new(FitConditions {
            design: conditions.project_rows(&linear.design),
            residual: conditions.project_rows(&residual).column(0).into_owned(),
            conditions,
        });
        let reading = |row: &LinearRow| ReadingId::of(row, linear);
        let readings = linear.rows.iter().map(reading).collect();
        let measured = linear.rows.iter().map(|row| row.row).collect();
        Self::in_noise(fit, &described, (readings, measured))
    }

    /// The residuals of the same fit if the readings of each class had another variance, given over the described one in
    /// the order of [`Self::classes`]: the linearised problem is weighted accordingly and solved again.
    pub fn with_variances(&self, variance: &[f64]) -> Self {
        let rows = (self.readings.clone(), self.measured.clone());
        Self::in_noise(Rc::clone(&self.fit), variance, rows)
    }

    fn in_noise(
        fit: Rc<FitConditions>,
        variance: &[f64],
        (readings, measured): (Vec<Option<ReadingId>>, Vec<Option<usize>>),
    ) -> Self {
        let noise = fit.conditions.noise(variance);
        let mut design = fit.design.clone();
        noise.whiten(&mut design);
        let mut residual = DMatrix::from_column_slice(design.nrows(), 1, fit.residual.as_slice());
        noise.whiten(&mut residual);
        let projector = Projector::new(&design, &residual.column(0).into_owned());
        let mut space = Self {
            residual: DVector::zeros(readings.len()),
            blocks: Vec::with_capacity(fit.conditions.blocks.len()),
            fitted: DMatrix::zeros(projector.rank(), readings.len()),
            readings,
            measured,
            fit: Rc::clone(&fit),
        };
        for (rows, conditions, basis) in noise.bases() {
            let (first, count) = (conditions.start, conditions.len());
            let part = projector.residual.rows(first, count);
            let mut to = space.residual.rows_mut(rows.start, rows.len());
            to.gemv_tr(1.0, &basis, &part, 0.0);
            let part = projector.basis().rows(first, count);
            let mut to = space.fitted.columns_mut(rows.start, rows.len());
            to.gemm_tr(1.0, &part, &basis, 0.0);
            space.blocks.push(Block { rows, basis });
        }
        space
    }

    /// The classes of readings, each with a variance of its own.
    pub fn classes(&self) -> &[ReadingId] {
        &self.fit.conditions.classes
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.residual.len()
    }

    /// Redundancy of each row, the diagonal of `M`: the share of an error that shows in its own residual.
    pub fn redundancy(&self) -> Vec<f64> {
        let mut redundancy = vec![0.0; self.rows()];
        for block in &self.blocks {
            for (row, basis) in block.rows.clone().zip(block.basis.column_iter()) {
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
            let alone = block.basis.tr_mul(&block.basis);
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
                let basis = block.basis.select_columns(&local);
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

//! The normal equations of the common parameters: poses eliminated, home row and priors included.

use nalgebra::{DMatrix, DVector, Matrix3, Matrix6};

use super::covariance::{covariance_of, is_regular};
use super::distances::Distances;
use super::evaluator::{Layout, Sums};
use super::globals::Globals;
use super::home::{HomeRow, direct_column};
use super::parameter::{Parameter, ParameterId};
use super::problem::Problem;
use crate::geometry::{Coordinate, rotation_vector_jacobian_inverse};
use crate::real::Packet;

/// Whitened residuals of the priors and their derivatives.
#[derive(Debug, Clone)]
pub(super) struct Priors {
    /// Residual of each prior, 0 for parameters without one.
    pub residuals: Vec<f64>,
    /// Nonzero derivatives: residual, parameter, value.
    pub derivatives: Vec<(usize, usize, f64)>,
    /// Sum of squares.
    pub loss: f64,
}

impl Priors {
    /// Evaluates the priors at the present values.
    pub fn evaluate(problem: &Problem<'_>, globals: &Globals, parameters: &[Parameter]) -> Self {
        let deviations = globals.deviations(problem, parameters);
        let home = Globals::nominal_home(problem);
        let phi = globals
            .home
            .difference(&home)
            .fixed_rows::<3>(3)
            .into_owned();
        let turn = rotation_vector_jacobian_inverse(&phi);
        let mut residuals = vec![0.0; parameters.len()];
        let mut derivatives = Vec::with_capacity(parameters.len());
        for (row, parameter) in parameters.iter().enumerate() {
            let is_home = matches!(parameter.id, ParameterId::Home(_));
            if let (Some(sd), false) = (parameter.prior_sd, is_home) {
                residuals[row] = deviations[row] / sd;
                derivatives.push((row, row, sd.recip()));
            }
        }
        // A measured home pose has correlated coordinates: their rows are whitened together.
        let home_rows = home_rows(parameters);
        let weight = home_weight(problem, &home_rows);
        for (row, of) in &home_rows {
            let weight = |by: Coordinate| weight[(of.index(), by.index())];
            for (column, moved) in &home_rows {
                residuals[*row] += weight(*moved) * deviations[*column];
                let slopes = home_rows
                    .iter()
                    .map(|(_, by)| weight(*by) * by_step(&turn, *by, *moved));
                derivatives.push((*row, *column, slopes.sum()));
            }
        }
        Self {
            loss: residuals.iter().map(|r| r * r).sum(),
            residuals,
            derivatives,
        }
    }
}

/// Indices of the home pose's parameters, with their coordinates.
fn home_rows(parameters: &[Parameter]) -> Vec<(usize, Coordinate)> {
    let home = |(row, parameter): (usize, &Parameter)| match parameter.id {
        ParameterId::Home(coordinate) => Some((row, coordinate)),
        _ => None,
    };
    parameters.iter().enumerate().filter_map(home).collect()
}

/// `L^-1` of the covariance `L L^T` of the estimated coordinates of the home pose; the others are
/// left out as if they were independent.
fn home_weight(problem: &Problem<'_>, rows: &[(usize, Coordinate)]) -> Matrix6<f64> {
    let Some(home) = problem.dataset.robot.home.filter(|_| !rows.is_empty()) else {
        return Matrix6::zeros();
    };
    let all = home.covariance();
    let mut covariance = Matrix6::identity();
    for (_, i) in rows {
        for (_, k) in rows {
            covariance[(i.index(), k.index())] = all[(i.index(), k.index())];
        }
    }
    // The covariance is positive definite because descriptions are checked on loading.
    let factor = covariance.cholesky().map(|factor| factor.l());
    let inverse = factor.and_then(|l| l.solve_lower_triangular(&Matrix6::identity()));
    inverse.unwrap_or_else(Matrix6::zeros)
}

/// Information of the prior of the home pose, parameters x parameters: the gain of one more measurement as good as all so far.
pub(super) fn home_information(problem: &Problem<'_>, parameters: &[Parameter]) -> DMatrix<f64> {
    let rows = home_rows(parameters);
    let weight = home_weight(problem, &rows);
    let own = weight.tr_mul(&weight);
    let mut information = DMatrix::zeros(parameters.len(), parameters.len());
    for (row, i) in &rows {
        for (column, k) in &rows {
            information[(*row, *column)] = own[(i.index(), k.index())];
        }
    }
    information
}

/// Derivative of a coordinate of the home pose's deviation by a step of another one; `turn` maps rotation steps.
fn by_step(turn: &Matrix3<f64>, of: Coordinate, by: Coordinate) -> f64 {
    match (of.index(), by.index()) {
        (of @ 3.., by @ 3..) => turn[(of - 3, by - 3)],
        (of, by) => f64::from(u8::from(of == by)),
    }
}

/// Symmetric system `information * step = -gradient`.
#[derive(Debug, Clone)]
pub(super) struct System {
    pub information: DMatrix<f64>,
    pub gradient: DVector<f64>,
}

/// Dependence of the columns before mapping on the parameters.
#[derive(Debug, Clone)]
pub(super) struct ColumnMap {
    /// Column of each parameter that has one of its own.
    direct: Vec<Option<usize>>,
    /// Columns of the unstrained lengths at home, per cable.
    lengths: Vec<usize>,
    columns: usize,
}

impl ColumnMap {
    pub fn new(problem: &Problem<'_>, parameters: &[Parameter], layout: &Layout) -> Self {
        Self {
            direct: parameters
                .iter()
                .map(|p| direct_column(&p.id, layout, problem))
                .collect(),
            lengths: (0..layout.cables)
                .map(|c| layout.home_length_column(c))
                .collect(),
            columns: layout.columns,
        }
    }

    /// Step of the columns from a step of the parameters.
    pub fn column_step(&self, home: &HomeRow, step: &[f64]) -> Vec<f64> {
        let mut columns = vec![0.0; self.columns];
        for (column, delta) in self.direct.iter().zip(step) {
            if let Some(column) = column {
                columns[*column] = *delta;
            }
        }
        for (column, gradient) in self.lengths.iter().zip(&home.length_gradients) {
            columns[*column] = gradient.iter().map(|(k, d)| d * step[*k]).sum();
        }
        columns
    }
}

impl ColumnMap {
    /// Maps a derivative by the columns to one by the parameters.
    pub fn map_row(&self, home: &HomeRow, columns: &[f64]) -> Vec<f64> {
        let direct = |column: &Option<usize>| column.map_or(0.0, |column| columns[column]);
        let mut mapped: Vec<f64> = self.direct.iter().map(direct).collect();
        for (column, gradient) in self.lengths.iter().zip(&home.length_gradients) {
            for (parameter, slope) in gradient {
                mapped[*parameter] += slope * columns[*column];
            }
        }
        mapped
    }

    /// Covariance of the columns from that of the parameters.
    pub fn column_covariance(&self, home: &HomeRow, covariance: &DMatrix<f64>) -> DMatrix<f64> {
        let n = covariance.nrows();
        let mut map = DMatrix::zeros(self.columns, n);
        for (q, column) in self.direct.iter().enumerate() {
            if let Some(column) = column {
                map[(*column, q)] = 1.0;
            }
        }
        for (column, gradient) in self.lengths.iter().zip(&home.length_gradients) {
            for (q, slope) in gradient {
                map[(*column, *q)] = *slope;
            }
        }
        &map * covariance * map.transpose()
    }
}

impl System {
    /// Accumulates poses, home row and priors.
    pub fn build<T: Packet>(
        sums: &Sums<T>,
        map: &ColumnMap,
        home: &HomeRow,
        priors: &Priors,
    ) -> Self {
        let n = map.direct.len();
        let mut system = Self {
            information: DMatrix::zeros(n, n),
            gradient: DVector::zeros(n),
        };
        system.add_poses(sums, map, home);
        for (row, residual) in home.gradients.chunks_exact(n.max(1)).zip(&home.residuals) {
            system.add_row(row, *residual);
        }
        // The derivatives of one prior are adjacent.
        for row in priors.derivatives.chunk_by(|a, b| a.0 == b.0) {
            for (prior, i, a) in row {
                system.gradient[*i] += a * priors.residuals[*prior];
                for (_, k, b) in row {
                    system.information[(*i, *k)] += a * b;
                }
            }
        }
        system
    }

    /// Adds the rows that distances leave once the poses are eliminated.
    pub fn add_distances(&mut self, distances: &Distances) {
        let design = &distances.design;
        self.information.gemm_tr(1.0, design, design, 1.0);
        self.gradient
            .gemv_tr(1.0, design, &distances.remaining, 1.0);
    }

    fn add_row(&mut self, row: &[f64], residual: f64) {
        for (i, a) in row.iter().enumerate().filter(|(_, a)| **a != 0.0) {
            self.gradient[i] += a * residual;
            for (k, b) in row.iter().enumerate() {
                self.information[(k, i)] += a * b;
            }
        }
    }

    fn add_poses<T: Packet>(&mut self, sums: &Sums<T>, map: &ColumnMap, home: &HomeRow) {
        let triangle = sums.information();
        let gradient = sums.gradient();
        let at = |i: usize, k: usize| {
            let (i, k) = (i.max(k), i.min(k));
            triangle[i * (i + 1) / 2 + k]
        };
        let direct: Vec<(usize, usize)> = map
            .direct
            .iter()
            .enumerate()
            .filter_map(|(q, column)| column.map(|column| (q, column)))
            .collect();
        for (k, (q, column)) in direct.iter().enumerate() {
            self.gradient[*q] += gradient[*column];
            for (p, other) in &direct[..k] {
                let value = at(*column, *other);
                self.information[(*p, *q)] += value;
                self.information[(*q, *p)] += value;
            }
            self.information[(*q, *q)] += at(*column, *column);
        }
        // With the gradients `G` of the lengths, the information `V` of the lengths and `D` between them and the
        // parameters, this adds `G (D + V G^T) + D^T G^T`.
        for (column, terms) in map.lengths.iter().zip(&home.length_gradients) {
            let mut own = DVector::zeros(map.direct.len());
            for (p, other) in &direct {
                own[*p] = at(*column, *other);
            }
            let mut all = own.clone();
            for (other, more) in map.lengths.iter().zip(&home.length_gradients) {
                let value = at(*column, *other);
                for (p, slope) in more {
                    all[*p] += value * slope;
                }
            }
            for (q, slope) in terms {
                self.gradient[*q] += slope * gradient[*column];
                self.information.column_mut(*q).axpy(*slope, &all, 1.0);
            }
            for (p, _) in &direct {
                for (q, slope) in terms {
                    self.information[(*q, *p)] += own[*p] * slope;
                }
            }
        }
    }

    /// Inverse of the information; `None` if it is singular to working precision.
    pub fn covariance(&self) -> Option<DMatrix<f64>> {
        covariance_of(&self.information)
    }

    /// Damped step, and the reduction of the loss that the undamped system predicts for it; `None`
    /// if the damped system is singular.
    pub fn step(&self, damping: f64) -> Option<(DVector<f64>, f64)> {
        let mut damped = self.information.clone();
        for k in 0..damped.nrows() {
            // A parameter that nothing depends on keeps its value.
            let diagonal = damped[(k, k)];
            damped[(k, k)] = if diagonal == 0.0 {
                1.0
            } else {
                diagonal * (1.0 + damping)
            };
        }
        let factor = damped.cholesky()?;
        if damping == 0.0 && !is_regular(factor.l_dirty(), &self.information) {
            return None;
        }
        let step = factor.solve(&-&self.gradient);
        let predicted = -step.dot(&self.gradient);
        Some((step, predicted))
    }
}

//! Residuals of the cable lengths at a pose, condensed to normal equations.

use pulp::Simd;

use super::super::cable_arrays::CableArrays;
use crate::geometry::PosePacket;
use crate::real::{Lanes, Packet, Real, add_scaled, cross, negated, scaled};
use crate::small_cholesky::{TRIANGLE, back_substitute, entry, factorise, forward_substitute};

/// `sum r^2`, `J^T r` and `J^T J` of the length residuals `r = l(pose) - l_measured` with respect to
/// the twist of the platform (m^2, m^2 and m^2/rad, ..).
#[derive(Debug, Clone, Copy)]
pub(super) struct NormalEquations {
    pub(super) cost: f64,
    pub(super) gradient: [f64; 6],
    pub(super) matrix: [f64; TRIANGLE],
    /// Sum over the cables (m^2) of the depth of their anchors inside their pulleys.
    pub(super) blocked: f64,
}

/// Accumulates the normal equations at a pose; cables whose length is NaN are left out. `lengths` is
/// padded with NaN to whole vectors.
#[inline(always)]
pub(super) fn assemble<S: Simd>(
    simd: S,
    cables: &CableArrays,
    lengths: &[f64],
    pose: &PosePacket<f64>,
) -> NormalEquations {
    let zero = Lanes::splat(simd, 0.0);
    let (mut cost, mut blocked) = (zero, zero);
    let mut gradient = [zero; 6];
    let mut matrix = [zero; TRIANGLE];
    let pose = pose.splat(simd);
    for index in 0..cables.vectors::<S>() {
        let (length, weight) = Lanes::load(simd, lengths, index).present();
        let arm = cables.arms(simd, index, &pose);
        let anchor = add_scaled(pose.position, zero.lift(1.0), arm);
        let path = cables.pulleys(simd, index).path_to(anchor);
        let residual = (path.length - length) * weight;
        // Row of J: minus [u; (R b) x u].
        let down = scaled(path.toward_exit, -weight);
        let turn = cross(arm, down);
        let row = [down[0], down[1], down[2], turn[0], turn[1], turn[2]];
        cost = residual.mul_add(residual, cost);
        blocked = blocked + (-path.clearance).max(zero) * weight;
        for i in 0..6 {
            gradient[i] = row[i].mul_add(residual, gradient[i]);
            for j in 0..=i {
                matrix[entry(i, j)] = row[i].mul_add(row[j], matrix[entry(i, j)]);
            }
        }
    }
    let mut sums = NormalEquations {
        cost: cost.sum(),
        gradient: [0.0; 6],
        matrix: [0.0; TRIANGLE],
        blocked: blocked.sum(),
    };
    for i in 0..6 {
        sums.gradient[i] = gradient[i].sum();
    }
    for i in 0..TRIANGLE {
        sums.matrix[i] = matrix[i].sum();
    }
    sums
}

impl NormalEquations {
    /// Locks the coordinates that are not free: no gradient, a unit on the diagonal.
    #[inline(always)]
    pub(super) fn lock(&mut self, free: &[bool; 6]) {
        for i in 0..6 {
            if free[i] {
                continue;
            }
            self.gradient[i] = 0.0;
            for j in 0..6 {
                self.matrix[entry(i.max(j), i.min(j))] = if i == j { 1.0 } else { 0.0 };
            }
        }
    }

    /// The step `-(J^T J + damping diag(J^T J))^-1 J^T r`, `None` where the matrix is singular.
    #[inline(always)]
    pub(super) fn step(&self, damping: f64) -> Option<[f64; 6]> {
        let factor = self.factor(damping)?;
        let mut step = negated(self.gradient);
        forward_substitute(&factor, &mut step);
        back_substitute(&factor, &mut step);
        Some(step)
    }

    #[inline(always)]
    fn factor(&self, damping: f64) -> Option<[f64; TRIANGLE]> {
        let mut factor = self.matrix;
        factorise(&mut factor, damping);
        (0..6).all(|k| factor[entry(k, k)] > 0.0).then_some(factor)
    }

    /// Smallest pivot of the Cholesky factor relative to its column: the sine of the smallest
    /// angle between a column of `J` and those before it. 0 at a singular pose.
    #[inline(always)]
    pub(super) fn conditioning(&self) -> f64 {
        let Some(factor) = self.factor(0.0) else {
            return 0.0;
        };
        (0..6).fold(1.0, |least: f64, i| {
            let inverse_pivot = factor[entry(i, i)];
            least.min(1.0 / (inverse_pivot * self.matrix[entry(i, i)].sqrt()))
        })
    }

    /// Reduction of the cost that the linear model predicts for `step`.
    #[inline(always)]
    pub(super) fn predicted_reduction(&self, step: &[f64; 6]) -> f64 {
        let mut curvature = 0.0;
        let mut slope = 0.0;
        for i in 0..6 {
            slope += self.gradient[i] * step[i];
            for j in 0..6 {
                curvature += self.matrix[entry(i.max(j), i.min(j))] * step[i] * step[j];
            }
        }
        -2.0 * slope - curvature
    }
}

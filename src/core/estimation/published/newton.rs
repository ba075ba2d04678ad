//! Forward kinematics by plain Newton steps with a forward-difference Jacobian, as published.

use nalgebra::{DMatrix, DVector};
use pulp::{Arch, Simd, WithSimd};

use crate::geometry::{Pose, PosePacket, Twist};
use crate::kinematics::{CableArrays, KinematicsError, MAX_CABLES};
use crate::real::{Lanes, Packet, Real, add_scaled};
use crate::robot::Robot;

use super::pseudo_inverse_times;

/// Largest number of Newton steps.
const STEPS: usize = 30;
/// The poses are solved when none of them moves by as much (m, rad).
const STEP_STOP: f64 = 1e-10;
/// Below this ratio of pivot to column norm, the triangular solution gives way to singular values.
const SOUND_PIVOT: f64 = 1e-9;

type Lengths = [f64; MAX_CABLES];

/// Plain Newton for all poses at once.
pub(super) struct PlainNewton {
    cables: CableArrays,
    free: Vec<usize>,
    arch: Arch,
    /// Step of the forward differences (m, rad).
    difference: f64,
}

/// Poses at which Newton's method stopped.
pub(super) struct Found {
    pub(super) poses: Vec<Pose>,
    /// Length residuals (m), row-major.
    pub(super) residuals: Vec<f64>,
}

impl PlainNewton {
    pub(super) fn new(robot: &Robot, difference: f64) -> Result<Self, KinematicsError> {
        let freedom = robot.platform.freedom();
        let free = freedom.coordinates().iter().map(|c| c.index());
        Ok(Self {
            cables: CableArrays::new(robot)?,
            free: free.collect(),
            arch: Arch::new(),
            difference,
        })
    }

    pub(super) fn set_entry_points(&mut self, entries: &[[f64; 3]]) {
        self.cables.set_entry_points(entries);
    }

    /// Geometric lengths at a pose (m).
    pub(super) fn lengths(&self, pose: &Pose) -> Vec<f64> {
        self.lengths_at(pose)[..self.cables.count()].to_vec()
    }

    fn lengths_at(&self, pose: &Pose) -> Lengths {
        self.arch.dispatch(LengthsAt {
            cables: &self.cables,
            pose: PosePacket::from(pose),
        })
    }

    /// Solves for the poses with the given lengths (m, row-major) from the given starts.
    pub(super) fn solve(&self, lengths_m: &[f64], starts: &[Pose]) -> Found {
        let m = self.cables.count();
        let mut poses = starts.to_vec();
        for _ in 0..STEPS {
            let mut at_rest = true;
            for (pose, measured) in poses.iter_mut().zip(lengths_m.chunks_exact(m)) {
                let step = self.step(pose, measured);
                at_rest &= step.iter().all(|v| v.abs() < STEP_STOP);
                *pose = pose.perturbed(&step);
            }
            if at_rest {
                break;
            }
        }
        let mut residuals = Vec::with_capacity(lengths_m.len());
        for (pose, measured) in poses.iter().zip(lengths_m.chunks_exact(m)) {
            let lengths = self.lengths_at(pose);
            residuals.extend(lengths.iter().zip(measured).map(|(l, read)| l - read));
        }
        Found { poses, residuals }
    }

    /// `-pinv(J) r` as a twist.
    fn step(&self, pose: &Pose, measured: &[f64]) -> Twist {
        let (m, n) = (self.cables.count(), self.free.len());
        let here = self.lengths_at(pose);
        let mut system = System {
            m,
            n,
            columns: [[0.0; MAX_CABLES]; 7],
        };
        for (column, k) in self.free.iter().enumerate() {
            let there = self.lengths_at(&pose.perturbed(&Twist::ith(*k, self.difference)));
            for i in 0..m {
                // Differences of residuals, not of lengths, as published: their rounding is that of the reference.
                let (after, before) = (there[i] - measured[i], here[i] - measured[i]);
                system.columns[column][i] = (after - before) / self.difference;
            }
        }
        for i in 0..m {
            system.columns[n][i] = measured[i] - here[i];
        }
        let solution = system.solve();
        let mut step = Twist::zeros();
        for (column, k) in self.free.iter().enumerate() {
            step[*k] = solution[column];
        }
        step
    }
}

/// Lengths of all cables at a pose.
struct LengthsAt<'a> {
    cables: &'a CableArrays,
    pose: PosePacket<f64>,
}

impl WithSimd for LengthsAt<'_> {
    type Output = Lengths;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Lengths {
        let mut lengths = [0.0; MAX_CABLES];
        let pose = self.pose.splat(simd);
        let one = Lanes::splat(simd, 1.0);
        for index in 0..self.cables.vectors::<S>() {
            let arm = self.cables.arms(simd, index, &pose);
            let anchor = add_scaled(pose.position, one, arm);
            let path = self.cables.pulleys(simd, index).path_to(anchor);
            // Where an anchor is inside its pulley, there is no length.
            let none = Lanes::splat(simd, f64::NAN);
            let length = (-path.clearance).select_positive(none, path.length);
            length.store(&mut lengths, index);
        }
        lengths
    }
}

/// A least squares problem `J x = b` with `b` as column `n`.
struct System {
    m: usize,
    n: usize,
    columns: [[f64; MAX_CABLES]; 7],
}

impl System {
    /// Minimum-norm solution: by modified Gram-Schmidt where `J` has full rank, which is equal
    /// up to rounding, else by singular values.
    fn solve(&self) -> [f64; 6] {
        self.triangular()
            .unwrap_or_else(|| self.by_singular_values())
    }

    fn triangular(&self) -> Option<[f64; 6]> {
        let (m, n) = (self.m, self.n);
        let mut q = self.columns;
        let mut r = [[0.0; 7]; 6];
        for k in 0..n {
            let norm =
                |column: &[f64; MAX_CABLES]| column[..m].iter().map(|v| v * v).sum::<f64>().sqrt();
            let pivot = norm(&q[k]);
            if pivot.is_nan() || pivot <= SOUND_PIVOT * norm(&self.columns[k]) {
                return None;
            }
            r[k][k] = pivot;
            for i in 0..m {
                q[k][i] /= pivot;
            }
            for j in k + 1..=n {
                let along: f64 = (0..m).map(|i| q[k][i] * q[j][i]).sum();
                r[k][j] = along;
                for i in 0..m {
                    q[j][i] -= along * q[k][i];
                }
            }
        }
        let mut x = [0.0; 6];
        for k in (0..n).rev() {
            let rest: f64 = (k + 1..n).map(|j| r[k][j] * x[j]).sum();
            x[k] = (r[k][n] - rest) / r[k][k];
        }
        Some(x)
    }

    fn by_singular_values(&self) -> [f64; 6] {
        let matrix = DMatrix::from_fn(self.m, self.n, |i, k| self.columns[k][i]);
        let right = DVector::from_column_slice(&self.columns[self.n][..self.m]);
        let solution = pseudo_inverse_times(matrix, &right);
        let mut x = [f64::NAN; 6];
        if let Some(solution) = solution {
            for (value, solved) in x.iter_mut().zip(&solution) {
                *value = *solved;
            }
        }
        x
    }
}

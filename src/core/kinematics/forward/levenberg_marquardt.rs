//! Levenberg-Marquardt iteration from one start.

use pulp::Simd;

use super::super::cable_arrays::CableArrays;
use super::normal::{NormalEquations, assemble};
use crate::geometry::PosePacket;

/// Largest number of steps tried from one start.
const MAX_STEPS: usize = 60;
/// Steps below this are converged (m, and rad: platforms are smaller than metres).
const STEP_TOLERANCE: f64 = 1e-11;
/// Longest rotation in one step (rad), beyond which the linear model does not hold.
const MAX_ROTATION: f64 = 0.8;
/// Damping after the first rejected step; before it, and below this value, steps are undamped.
const FIRST_DAMPING: f64 = 1e-3;
/// Damping beyond which no direction that reduces the residual is left.
const LAST_DAMPING: f64 = 1e10;

/// The pose that an iteration ended at.
#[derive(Debug, Clone, Copy)]
pub(super) struct Minimum {
    pub(super) pose: PosePacket<f64>,
    /// Sum of squared residuals (m^2).
    pub(super) cost: f64,
    /// Whether no step reduces the cost further.
    pub(super) converged: bool,
    /// Whether an anchor is inside its pulley.
    pub(super) blocked: bool,
    pub(super) conditioning: f64,
    pub(super) iterations: usize,
}

/// The least-squares problem: measured lengths to be matched in the free coordinates.
#[derive(Clone, Copy)]
pub(super) struct LengthProblem<'a> {
    pub(super) cables: &'a CableArrays,
    /// Measured lengths (m), padded with NaN to whole vectors.
    pub(super) measured: &'a [f64],
    pub(super) free: &'a [bool; 6],
}

impl LengthProblem<'_> {
    #[inline(always)]
    fn linearise<S: Simd>(&self, simd: S, pose: &PosePacket<f64>) -> NormalEquations {
        let mut normal = assemble(simd, self.cables, self.measured, pose);
        normal.lock(self.free);
        normal
    }
}

/// Minimises the sum of squared residuals from `start`.
#[inline(always)]
pub(super) fn minimise<S: Simd>(
    simd: S,
    problem: LengthProblem<'_>,
    start: PosePacket<f64>,
) -> Minimum {
    let mut iteration = LevenbergMarquardt {
        pose: start,
        normal: problem.linearise(simd, &start),
        damping: 0.0,
        last_step: 0.0,
        converged: false,
    };
    let mut iterations = 0;
    while iterations < MAX_STEPS && iteration.damping < LAST_DAMPING && !iteration.converged {
        iterations += 1;
        let Some(step) = iteration.normal.step(iteration.damping) else {
            iteration.damping = raised(iteration.damping);
            continue;
        };
        let step = limited(step);
        let trial = iteration.pose.moved(step);
        let normal = problem.linearise(simd, &trial);
        iteration.accept_or_damp(&step, trial, normal);
    }
    Minimum {
        pose: iteration.pose,
        cost: iteration.normal.cost,
        converged: iteration.converged,
        blocked: iteration.normal.blocked > 0.0,
        conditioning: iteration.normal.conditioning(),
        iterations,
    }
}

struct LevenbergMarquardt {
    pose: PosePacket<f64>,
    normal: NormalEquations,
    damping: f64,
    /// Largest component of the last accepted step; 0 before the first.
    last_step: f64,
    converged: bool,
}

impl LevenbergMarquardt {
    #[inline(always)]
    fn accept_or_damp(&mut self, step: &[f64; 6], trial: PosePacket<f64>, normal: NormalEquations) {
        let mut size = 0.0_f64;
        for value in step {
            size = size.max(value.abs());
        }
        let reduction = self.normal.cost - normal.cost;
        // Differences below the rounding of the lengths do not count as a reduction.
        let rounding = 1e-30 + 1e-14 * self.normal.cost;
        if reduction.is_nan() || reduction < -rounding {
            self.converged = size < STEP_TOLERANCE;
            self.damping = raised(self.damping);
            return;
        }
        let predicted = self.normal.predicted_reduction(step);
        self.damping = lowered(self.damping, reduction, predicted);
        (self.pose, self.normal) = (trial, normal);
        // If steps keep shrinking by this ratio, the remaining distance is their geometric sum.
        let ratio = if self.last_step > 0.0 {
            size / self.last_step
        } else {
            1.0
        };
        self.last_step = size;
        self.converged = size < STEP_TOLERANCE || (ratio < 0.3 && size * ratio < STEP_TOLERANCE);
    }
}

fn raised(damping: f64) -> f64 {
    (damping * 8.0).max(FIRST_DAMPING)
}

/// Damping after an accepted step: lowered where the linear model was right, none once it is small.
#[inline(always)]
fn lowered(damping: f64, reduction: f64, predicted: f64) -> f64 {
    if damping == 0.0 || reduction < 0.25 * predicted {
        return damping;
    }
    let less = damping
        * if reduction > 0.75 * predicted {
            0.1
        } else {
            0.5
        };
    if less < FIRST_DAMPING { 0.0 } else { less }
}

/// The step, scaled down to the longest rotation in one step.
#[inline(always)]
fn limited(step: [f64; 6]) -> [f64; 6] {
    let rotation = (step[3] * step[3] + step[4] * step[4] + step[5] * step[5]).sqrt();
    if rotation <= MAX_ROTATION {
        return step;
    }
    step.map(|v| v * (MAX_ROTATION / rotation))
}

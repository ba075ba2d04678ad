//! Options of the solver, and its progress reports.

/// Poses per part: one pass takes some milliseconds, beside which starting a thread is negligible. A multiple of the
/// packet size of every instruction set.
const POSES_PER_PART: usize = 1 << 14;
/// Number of common parameters up to which a part has so many poses. The work for a pose grows with their square.
const FEW_PARAMETERS: usize = 48;

/// Division of the poses between threads.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Division {
    /// Poses per part with few common parameters, a multiple of 8.
    pub poses_per_part: usize,
    /// Largest number of threads; `None`: as many as the processor runs at once.
    pub threads: Option<usize>,
}

impl Division {
    /// Size of the parts of so many poses with a number of common parameters: equal, in whole packets of every instruction
    /// set, and such that a part is about as much work whatever that number.
    pub(super) fn part_size(&self, poses: usize, parameters: usize) -> usize {
        let few = FEW_PARAMETERS * FEW_PARAMETERS;
        let all = (parameters * parameters).max(few);
        let most = (self.poses_per_part * few / all).next_multiple_of(8).max(8);
        let parts = poses.div_ceil(most).max(1);
        poses.div_ceil(parts).next_multiple_of(8).max(8)
    }
}

impl Default for Division {
    fn default() -> Self {
        Self {
            poses_per_part: POSES_PER_PART,
            threads: None,
        }
    }
}

/// Options of the solver. The defaults suit every problem; other values are for tests and special cases.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// Largest number of steps.
    pub max_iterations: usize,
    /// Converged if the predicted reduction of the loss is less than this fraction of it.
    pub tolerance: f64,
    /// Reduction of the loss that is not worth another pass of the joint method: 2e-5 is about a two-hundredth of
    /// a standard deviation. With exact tensions, `tolerance` alone decides.
    pub negligible: f64,
    /// Levenberg-Marquardt damping, relative to the diagonal, after an undamped step has failed; each further failure
    /// multiplies it by ten, each success divides it by ten.
    pub first_damping: f64,
    /// Damping below which steps are taken undamped, as it would cost quadratic convergence and gain nothing.
    pub least_damping: f64,
    /// Damping at which the solver gives up: the steps are then lost in rounding.
    pub most_damping: f64,
    /// Relative increase of the loss at which a step of the joint method is still accepted. The weights of latent tensions
    /// follow the linearisation, so the loss need not fall strictly from step to step close to the solution.
    pub accepted_increase: f64,
    /// Passes in which latent tensions settle when the solve starts at a known solution; from further away, steps need more.
    pub settling_passes: usize,
    /// Largest chi-square per degree of freedom at which a known solution serves as start: beyond it, effects missing from its
    /// model may have led it into a local minimum.
    pub largest_start_misfit: f64,
    /// Chi-square per degree of freedom beyond which a minimum is taken as a local one and the solve starts again at the poses
    /// from forward kinematics: no drawing or instrument is wrong by so much.
    pub local_minimum_misfit: f64,
    /// Division of the poses between threads; the number of threads does not change the result.
    pub division: Division,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            max_iterations: 100,
            tolerance: 1e-11,
            negligible: 2e-5,
            first_damping: 1e-4,
            least_damping: 1e-7,
            most_damping: 1e12,
            accepted_increase: 1e-2,
            settling_passes: 3,
            largest_start_misfit: 20.0,
            local_minimum_misfit: 1e3,
            division: Division::default(),
        }
    }
}

impl Options {
    /// Damping after a failed step.
    pub(super) fn raised(&self, damping: f64) -> f64 {
        (damping * 10.0).max(self.first_damping)
    }

    /// Damping after a successful step.
    pub(super) fn lowered(&self, damping: f64) -> f64 {
        let lower = damping * 0.1;
        if lower < self.least_damping {
            0.0
        } else {
            lower
        }
    }
}

/// State of a running solve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// Number of steps taken.
    pub iteration: usize,
    /// Present loss (chi-square for least squares).
    pub loss: f64,
    /// Reduction of the loss that the linearised problem predicts for the next step.
    pub predicted_reduction: f64,
    /// Levenberg-Marquardt damping, relative to the diagonal of the information.
    pub damping: f64,
}

/// Decision of an observer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Control {
    /// Continue.
    Continue,
    /// Stop and return the present state.
    Cancel,
}

/// Reason why a solve ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Termination {
    /// The predicted reduction of the loss is negligible.
    Converged,
    /// The largest number of iterations was reached.
    IterationLimit,
    /// No step lowers the loss, or the loss is not a number.
    Stalled,
    /// The observer cancelled.
    Cancelled,
}

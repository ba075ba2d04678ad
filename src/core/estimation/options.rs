//! Options of the solver and what it reports while it runs.

/// Poses of a part: some milliseconds of work for a pass, against which a thread costs nothing. Whole packets of every
/// instruction set.
const POSES_PER_PART: usize = 1 << 14;

/// How many poses are divided.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Division {
    /// Poses of a part, a multiple of 8.
    pub poses_per_part: usize,
    /// Most threads; as many as the processor runs at once without a number.
    pub threads: Option<usize>,
}

impl Default for Division {
    fn default() -> Self {
        Self {
            poses_per_part: POSES_PER_PART,
            threads: None,
        }
    }
}

/// How to solve. The defaults suit every problem; the rest is for tests and special cases.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// Most steps.
    pub max_iterations: usize,
    /// Converged when a step is predicted to lower the loss by less than this part of it.
    pub tolerance: f64,
    /// Reduction of the loss that is not worth another pass of the joint method: 2e-5 is about a two-hundredth of
    /// a standard deviation. With exact tensions the minimum is sought to `tolerance` alone.
    pub negligible: f64,
    /// Levenberg-Marquardt damping, relative to the diagonal, after an undamped step has failed; each further failure
    /// multiplies it by ten, each success divides it by ten.
    pub first_damping: f64,
    /// Damping below which steps are taken undamped: it costs quadratic convergence and gains nothing.
    pub least_damping: f64,
    /// Damping at which the solver gives up: steps are then lost in rounding.
    pub most_damping: f64,
    /// Relative increase of the loss with which a step of the joint method is accepted. The weights of latent tensions
    /// follow the linearisation, so the loss need not fall strictly from step to step close to the solution.
    pub accepted_increase: f64,
    /// Passes in which latent tensions settle when the solve starts at a known solution; from afar steps need more.
    pub settling_passes: usize,
    /// Chi-square per degree of freedom up to which a known solution is started from: beyond, what its model lacks may
    /// have led it into a local minimum.
    pub largest_start_misfit: f64,
    /// Chi-square per degree of freedom of a local minimum, from which the solve starts again at the poses that forward
    /// kinematics gives: no drawing or instrument is wrong by so much.
    pub local_minimum_misfit: f64,
    /// How many poses are divided between threads; their number does not change the result.
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
    /// The damping after a failed step.
    pub(super) fn raised(&self, damping: f64) -> f64 {
        (damping * 10.0).max(self.first_damping)
    }

    /// The damping after a successful step.
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

/// Answer of an observer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Control {
    /// Go on.
    Continue,
    /// Stop; the present state is returned.
    Cancel,
}

/// Why a solve ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Termination {
    /// The next step is predicted to gain nothing worth taking.
    Converged,
    /// Too many iterations.
    IterationLimit,
    /// No step lowers the loss, or it is not a number.
    Stalled,
    /// The observer cancelled.
    Cancelled,
}

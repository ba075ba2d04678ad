//! Options of the solver and what it reports while it runs.

/// How to solve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// Most iterations.
    pub max_iterations: usize,
    /// Converged when a step promises to lower the loss by less than this part of it.
    pub tolerance: f64,
    /// Gain of the loss that is not worth another pass of the joint method: 2e-5 is about a two-hundredth of
    /// a standard deviation. With exact tensions the minimum is asked for to `tolerance` alone.
    pub negligible: f64,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            max_iterations: 100,
            tolerance: 1e-11,
            negligible: 2e-5,
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
    /// Decrease of the loss that the next step promises.
    pub predicted_reduction: f64,
    /// Levenberg-Marquardt damping.
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
    /// The next step promises no gain.
    Converged,
    /// Too many iterations.
    IterationLimit,
    /// No step lowers the loss.
    Stalled,
    /// The observer cancelled.
    Cancelled,
}

//! Where rounding ends: the limits below which a number counts as zero, in one place and each with its reason.
//!
//! A double has 16 digits. The matrices of an adjustment are sums of products over hundreds of rows whose sizes
//! differ by a few powers of ten, and eliminating the poses takes differences of such sums, which leaves 11 to 12 digits (and
//! not the same ones on each processor): what is smaller, relative to what it was computed from, is rounding.

/// A pivot of a Cholesky factorisation that is smaller than this part of its diagonal is zero: the parameter or
/// coordinate is not determined. Open directions of the test robots leave pivots of 1e-16 to 3e-12; the weakest that are
/// determined, 1e-5. One limit for steps, covariances and eliminated poses, so that no step is taken of which
/// the covariance is refused afterwards.
pub(crate) const SINGULAR_PIVOT: f64 = 1e-10;

/// An eigenvalue of a matrix scaled to a unit diagonal that is smaller than this part of the largest is zero. The
/// smallest eigenvalue is at most the smallest pivot, and a digit larger than [`SINGULAR_PIVOT`] so that each matrix which
/// the factorisation refuses has an open direction to be named.
pub(crate) const OPEN_EIGENVALUE: f64 = 1e-9;

/// Loss that is the rounding of a perfect fit, as of simulated data without noise.
pub(crate) const PERFECT_FIT: f64 = 1e-15;

/// Smallest tension (N) at which the formulas of a cable are evaluated: at none at all sag has no bound, and its formula
/// no value. Far below what any sensor resolves.
pub(crate) const SMALLEST_TENSION_N: f64 = 1e-6;

/// Square of a sine below which two directions are parallel: it is divided by, and only must not be zero.
pub(crate) const PARALLEL: f64 = 1e-30;

//! Tolerances for rounding: the limits below which a number counts as zero, each with its reason.
//!
//! A double has 16 digits. The matrices of an adjustment are sums of products over hundreds of rows whose sizes
//! differ by a few powers of ten, and eliminating the poses takes differences of such sums, which leaves 11 to 12 digits
//! (and not the same ones on each processor): anything smaller, relative to the terms it was computed from, is rounding.

/// A pivot of a Cholesky factorisation that is smaller than this fraction of its diagonal is zero: the parameter or
/// coordinate is not determined. Undetermined directions of the test robots leave pivots of 1e-16 to 3e-12; the weakest
/// determined ones, 1e-5. One limit serves steps, covariances and eliminated poses, so that no step is taken whose
/// covariance is rejected afterwards.
pub(crate) const SINGULAR_PIVOT: f64 = 1e-10;

/// An eigenvalue of a matrix scaled to a unit diagonal that is smaller than this fraction of the largest is zero. The
/// smallest eigenvalue is at most the smallest pivot; the limit is ten times [`SINGULAR_PIVOT`] so that each matrix that
/// the factorisation rejects has an undetermined direction to be named.
pub(crate) const OPEN_EIGENVALUE: f64 = 1e-9;

/// Loss that is only the rounding of a perfect fit, as of simulated data without noise.
pub(crate) const PERFECT_FIT: f64 = 1e-15;

/// Smallest tension (N) at which the formulas of a cable are evaluated: at zero tension the sag is unbounded. Far below
/// the resolution of any sensor.
pub(crate) const SMALLEST_TENSION_N: f64 = 1e-6;

/// Square of a sine below which two directions are parallel; it is a divisor and must only not be zero.
pub(crate) const PARALLEL: f64 = 1e-30;

//! Distances to measure with a tape between poses of a plan.
//!
//! With the derivatives `a` of a distance by the parameters and its variance `k`, both with the poses eliminated, the covariance
//! `C` of the parameters becomes `C - C a a^T C / (k + a^T C a)`. The distance that lowers the position error `tr(W C)` most is
//! taken, and the others, which share poses with it, are conditioned on it.

use nalgebra::{DMatrix, Vector3};

use crate::estimation::ExpectedDistances;
use crate::geometry::Pose;
use crate::measurement::DistanceReading;

/// Standard deviation of a steel tape (m).
pub const TAPE_SD_M: f64 = 1e-3;
/// Number of distances to choose from: the longest, which show a common scale best.
const CANDIDATES: usize = 400;
/// Number of distances proposed: each is measured by hand.
const DISTANCES: usize = 4;

/// A distance to measure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlannedDistance {
    /// The poses by their place in the plan; `None` for home.
    pub between: [Option<usize>; 2],
    /// Distance of the platform's origin between them (m).
    pub distance_m: f64,
    /// Root mean square position error of the platform (m) with this distance and those before it, see
    /// [`DesignCriteria::platform_m`](super::DesignCriteria::platform_m).
    pub platform_m: f64,
}

/// The longest distances between the poses of successive rows, as a tape would measure them.
pub(super) fn candidates(poses: &[Pose]) -> Vec<DistanceReading> {
    let mut longest: Vec<DistanceReading> = Vec::new();
    for (row, pose) in poses.iter().enumerate() {
        longest.extend(poses[..row].iter().enumerate().map(|(other, from)| {
            let between: Vector3<f64> = pose.position - from.position;
            DistanceReading {
                number: 1,
                rows: [other, row],
                point_m: [0.0; 3],
                distance_m: between.norm(),
                sd_m: TAPE_SD_M,
            }
        }));
        // Thousands of poses have millions of pairs.
        longest.sort_by(|a, b| b.distance_m.total_cmp(&a.distance_m));
        longest.truncate(CANDIDATES);
    }
    longest
}

/// Chooses distances for parameters with a covariance, and returns the index of each with the position error (m) that it leaves. The
/// weights are those of [`position_weights`](super::position_weights).
pub(super) fn choose(
    candidates: ExpectedDistances,
    mut covariance: DMatrix<f64>,
    weights: &DMatrix<f64>,
) -> Vec<(usize, f64)> {
    let ExpectedDistances {
        mut rows,
        covariance: mut coupling,
    } = candidates;
    let mut chosen: Vec<(usize, f64)> = Vec::new();
    while chosen.len() < DISTANCES {
        let shifts = &rows * &covariance;
        let weighted = &shifts * weights;
        let variance = |k: usize| coupling[(k, k)] + shifts.row(k).dot(&rows.row(k));
        let gain = |k: &usize| weighted.row(*k).dot(&shifts.row(*k)) / variance(*k);
        let is_free = |k: &usize| chosen.iter().all(|(other, _)| other != k);
        let free = (0..rows.nrows()).filter(is_free);
        let Some(best) = free.max_by(|a, b| gain(a).total_cmp(&gain(b))) else {
            break;
        };
        let shift = shifts.row(best);
        covariance -= shift.transpose() * shift / variance(best);
        chosen.push((best, weights.dot(&covariance).max(0.0).sqrt()));
        let share = coupling.column(best) / coupling[(best, best)];
        let (row, coupled) = (rows.row(best).into_owned(), coupling.row(best).into_owned());
        rows -= &share * row;
        coupling -= share * coupled;
    }
    chosen
}

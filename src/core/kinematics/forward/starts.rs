//! Starting poses of forward kinematics.

use super::super::cable_arrays::CableArrays;
use super::ForwardKinematics;
use crate::geometry::{Pose, Vec3};
use crate::robot::Robot;

/// Largest component of the rotation vector of a random start (rad).
const MAX_ROTATION: f64 = 1.2;
/// Half-width of the box of further starts, relative to that of the frame.
const SPREAD: f64 = 0.6;

/// Diagonal of the box around the entry points (m).
pub(super) fn frame_size(cables: &CableArrays) -> f64 {
    half_width(cables).norm() * 2.0
}

fn half_width(cables: &CableArrays) -> Vec3 {
    Vec3::from_fn(|k, _| {
        let (low, high) = cables.entry_range(k);
        0.5 * (high - low)
    })
}

/// Centroid of the entry points, or a point below it, along gravity, if they all lie at one height: there
/// the platform hangs, and at that height itself vertical motion would change no length to first order.
pub(super) fn centre(cables: &CableArrays, robot: &Robot, frame_size_m: f64) -> Pose {
    let mut position = Vec3::from(cables.entry_centroid());
    let down = robot.gravity().try_normalize(1e-9).unwrap_or_default();
    let heights = robot
        .cables
        .iter()
        .map(|cable| down.dot(&Vec3::from(cable.pulley.entry_point_m)));
    let (low, high) = heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), h| {
        (low.min(h), high.max(h))
    });
    let freedom = robot.platform.freedom();
    if high - low < 0.1 * frame_size_m {
        let drop = down * (0.3 * frame_size_m);
        for coordinate in freedom.coordinates().iter().filter(|c| c.index() < 3) {
            position[coordinate.index()] += drop[coordinate.index()];
        }
    }
    Pose {
        position,
        ..Pose::identity()
    }
}

/// Further start number `number`, counted from 1; only the free coordinates differ from
/// `start`.
///
/// A small platform converges to its position from almost anywhere, but not to its orientation. So the first starts
/// rotate the platform at the best minimum so far; the others follow a Halton sequence around the centre.
pub(super) fn further(
    problem: &ForwardKinematics,
    start: &Pose,
    best: &Pose,
    number: usize,
) -> Pose {
    let turning = number <= ROTATIONS.len();
    let target = if turning { best } else { &problem.centre };
    let mut twist = target.difference(start);
    if turning {
        for k in 0..3 {
            twist[3 + k] = ROTATIONS[number - 1][k];
        }
    } else {
        // Along the normal of a flat frame the platform may still be far away, so use a fraction of the size.
        let least = 0.25 * problem.frame_size_m;
        let half = half_width(&problem.cables).map(|v| v.max(least));
        for k in 0..6 {
            let scale = if k < 3 {
                SPREAD * half[k]
            } else {
                MAX_ROTATION
            };
            twist[k] += scale * (2.0 * halton(number, BASES[k]) - 1.0);
        }
    }
    for k in (0..6).filter(|k| !problem.free[*k]) {
        twist[k] = 0.0;
    }
    start.perturbed(&twist)
}

/// Rotation vectors of the first further starts, relative to the given start (rad).
const ROTATIONS: [[f64; 3]; 6] = [
    [0.0, 0.0, 0.6],
    [0.0, 0.0, -0.6],
    [0.6, 0.0, 0.0],
    [-0.6, 0.0, 0.0],
    [0.0, 0.6, 0.0],
    [0.0, -0.6, 0.0],
];
const BASES: [usize; 6] = [2, 3, 5, 7, 11, 13];

/// Element `index` of the van der Corput sequence to `base`, in (0, 1).
fn halton(mut index: usize, base: usize) -> f64 {
    let (mut fraction, mut value) = (1.0, 0.0);
    while index > 0 {
        fraction /= base as f64;
        value += fraction * (index % base) as f64;
        index /= base;
    }
    value
}

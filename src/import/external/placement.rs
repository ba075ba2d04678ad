//! Alignment of an instrument's frame to the robot's frame, and of the tracked body to the platform.

use nalgebra::{Matrix3, Matrix4, Quaternion, SMatrix, SVector, UnitQuaternion};
use tautline_core::geometry::{Pose, Twist, Vec3};

use super::rigid_body::{fit_pose, is_spread};

/// Minimum number of poses to estimate both transformations.
pub(super) const FEWEST: usize = 6;
/// Maximum number of Gauss-Newton steps; a few suffice.
const STEPS: usize = 30;
/// Step size at convergence (m, rad).
const CONVERGED: f64 = 1e-12;
/// Standard deviation of the body's place on the platform (m), where the poses do not show it.
const BODY_SD_M: f64 = 0.5;

/// Measured pose of the body with the pose of the platform.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pair {
    /// Position of the body in the instrument's frame (m).
    pub measured_m: Vec3,
    /// Orientation of the body in the instrument's frame, if measured.
    pub turned: Option<UnitQuaternion<f64>>,
    /// Pose of the platform in the robot's frame.
    pub platform: Pose,
}

/// Transformations between instrument and robot, and between body and platform.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Alignment {
    /// Pose of the instrument's frame in the robot's.
    pub frame: Pose,
    /// Pose of the body in the platform's frame.
    pub body: Pose,
    /// Root mean square of the remaining distances (m).
    pub rms_m: f64,
}

/// Finds the frame `(t, Q)` and the body `(o, R_b)` for which `t + Q p = r + R o` and `Q R_m = R R_b` at measured poses
/// `(p, R_m)` of the body and poses `(r, R)` of the platform, by least squares; either is given where it is known.
///
/// # Errors
/// If the poses are too few or collinear.
pub(super) fn align(
    pairs: &[Pair],
    known: (Option<Pose>, Option<Pose>),
) -> Result<Alignment, String> {
    if pairs.len() < FEWEST && known.0.is_none() {
        return Err(format!(
            "found {} poses with a known pose of the platform, expected {FEWEST} or more",
            pairs.len()
        ));
    }
    let mut body_m = known.1.map_or_else(Vec3::zeros, |body| body.position);
    let mut frame = match known.0 {
        Some(frame) => frame,
        None => closest(pairs, &body_m)?,
    };
    let is_free = [known.0.is_none(), known.0.is_none(), known.1.is_none()];
    for _ in 0..STEPS {
        let step = step(pairs, &frame, &body_m, is_free);
        frame = frame.perturbed(&Twist::new(
            step[0], step[1], step[2], step[3], step[4], step[5],
        ));
        body_m += Vec3::new(step[6], step[7], step[8]);
        if step.amax() < CONVERGED {
            break;
        }
    }
    let turns = pairs.iter().filter_map(|pair| {
        let turned = pair.turned?;
        Some(pair.platform.orientation.inverse() * frame.orientation * turned)
    });
    let orientation = known
        .1
        .map_or_else(|| mean_rotation(turns), |body| body.orientation);
    Ok(Alignment {
        frame,
        body: Pose {
            position: body_m,
            orientation,
        },
        rms_m: rms_m(pairs, &frame, &body_m),
    })
}

/// The frame that best aligns the measured positions with a point of the platform.
fn closest(pairs: &[Pair], body_m: &Vec3) -> Result<Pose, String> {
    let measured: Vec<Vec3> = pairs.iter().map(|pair| pair.measured_m).collect();
    let target = |pair: &Pair| pair.platform.transform(body_m);
    let targets: Vec<Vec3> = pairs.iter().map(target).collect();
    let fitted = fit_pose(&measured, &targets).filter(|_| is_spread(&measured));
    fitted.ok_or_else(|| {
        "found collinear measured positions, expected poses that spread in two directions".into()
    })
}

/// Residual `t + Q p - r - R o` at a pose (m).
fn residual(pair: &Pair, frame: &Pose, body_m: &Vec3) -> Vec3 {
    frame.transform(&pair.measured_m) - pair.platform.transform(body_m)
}

fn rms_m(pairs: &[Pair], frame: &Pose, body_m: &Vec3) -> f64 {
    let squares = pairs
        .iter()
        .map(|p| residual(p, frame, body_m).norm_squared());
    (squares.sum::<f64>() / pairs.len().max(1) as f64).sqrt()
}

/// Gauss-Newton step (m, rad) of shift, rotation and body position, as far as they are free. A body position that the poses
/// do not determine stays as it is.
fn step(pairs: &[Pair], frame: &Pose, body_m: &Vec3, is_free: [bool; 3]) -> SVector<f64, 9> {
    let variance = rms_m(pairs, frame, body_m).powi(2) / 3.0;
    let mut normal = SMatrix::<f64, 9, 9>::zeros();
    let mut right = SVector::<f64, 9>::zeros();
    for pair in pairs {
        let mut rows = SMatrix::<f64, 3, 9>::zeros();
        let lever = frame.orientation * pair.measured_m;
        let blocks = [
            Matrix3::identity(),
            -lever.cross_matrix(),
            -pair.platform.orientation.to_rotation_matrix().into_inner(),
        ];
        for (k, block) in blocks.iter().enumerate().filter(|(k, _)| is_free[*k]) {
            rows.fixed_view_mut::<3, 3>(0, 3 * k).copy_from(block);
        }
        normal += rows.transpose() * rows;
        right -= rows.transpose() * residual(pair, frame, body_m);
    }
    for k in 0..3 {
        let prior = (variance / (BODY_SD_M * BODY_SD_M)).max(1e-12);
        normal[(6 + k, 6 + k)] += prior;
        right[6 + k] -= prior * body_m[k];
    }
    for k in (0..9).filter(|k| !is_free[k / 3]) {
        normal[(k, k)] = 1.0;
        right[k] = 0.0;
    }
    let factor = normal.cholesky();
    factor.map_or_else(SVector::zeros, |factor| factor.solve(&right))
}

/// Mean rotation (Markley et al. 2007, DOI 10.2514/1.28949); the identity of no rotations.
fn mean_rotation(rotations: impl Iterator<Item = UnitQuaternion<f64>>) -> UnitQuaternion<f64> {
    let sum = rotations.fold(Matrix4::zeros(), |sum, q| {
        sum + q.coords * q.coords.transpose()
    });
    if sum == Matrix4::zeros() {
        return UnitQuaternion::identity();
    }
    let eigen = sum.symmetric_eigen();
    let largest = eigen.eigenvalues.imax();
    let q = eigen.eigenvectors.column(largest).into_owned();
    UnitQuaternion::from_quaternion(Quaternion::from(q))
}

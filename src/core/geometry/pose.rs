//! Rigid pose of the platform and its perturbation.

use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector6};

use super::Vec3;

/// Small motion `[dx dy dz, phi_x phi_y phi_z]` in base coordinates (m, rad).
///
/// It takes a pose `(r, R)` to `(r + d, exp(phi) R)`.
pub type Twist = Vector6<f64>;

/// Pose of the platform frame in the base frame: `p_base = position + orientation * p_platform`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// Origin of the platform frame in the base frame (m).
    pub position: Vec3,
    /// Rotation from the platform frame to the base frame.
    pub orientation: UnitQuaternion<f64>,
}

impl Pose {
    /// The pose in which both frames coincide.
    #[must_use]
    pub fn identity() -> Self {
        Self {
            position: Vec3::zeros(),
            orientation: UnitQuaternion::identity(),
        }
    }

    /// Pose from plain numbers: position (m) and quaternion, w first, which is normalised.
    #[must_use]
    pub fn from_parts(position_m: [f64; 3], orientation_wxyz: [f64; 4]) -> Self {
        let [w, x, y, z] = orientation_wxyz;
        Self {
            position: position_m.into(),
            orientation: UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z)),
        }
    }

    /// Pose from a position (m) and the angles of an inclinometer (rad): `R = Rx(roll) Ry(pitch) Rz(yaw)`.
    #[must_use]
    pub fn from_angles(position_m: [f64; 3], [roll, pitch, yaw]: [f64; 3]) -> Self {
        let about =
            |axis: usize, angle: f64| UnitQuaternion::from_scaled_axis(Vec3::ith(axis, angle));
        Self {
            position: position_m.into(),
            orientation: about(0, roll) * about(1, pitch) * about(2, yaw),
        }
    }

    /// Quaternion of the orientation, w first and not negative.
    #[must_use]
    pub fn orientation_wxyz(&self) -> [f64; 4] {
        let q = self.orientation.quaternion();
        let sign = if q.w < 0.0 { -1.0 } else { 1.0 };
        [q.w * sign, q.i * sign, q.j * sign, q.k * sign]
    }

    /// Base coordinates of a point given in the platform frame (m).
    #[must_use]
    pub fn transform(&self, point_in_platform: &Vec3) -> Vec3 {
        self.position + self.orientation * point_in_platform
    }

    /// The pose after the small motion `twist`.
    #[must_use]
    pub fn perturbed(&self, twist: &Twist) -> Self {
        let phi = Vec3::new(twist[3], twist[4], twist[5]);
        Self {
            position: self.position + twist.fixed_rows::<3>(0),
            orientation: UnitQuaternion::from_scaled_axis(phi) * self.orientation,
        }
    }

    /// The small motion that takes `reference` to this pose: its rotation part is
    /// `log(R R_ref^-1)`.
    #[must_use]
    pub fn difference(&self, reference: &Self) -> Twist {
        let d = self.position - reference.position;
        let phi = (self.orientation * reference.orientation.inverse()).scaled_axis();
        Twist::new(d.x, d.y, d.z, phi.x, phi.y, phi.z)
    }
}

/// Inverse left Jacobian of the rotation vector: `log(exp(delta) exp(phi)) = phi + J^-1 delta`.
///
/// `J^-1 = I - [phi]/2 + (1/t^2 - (1 + cos t) / (2 t sin t)) [phi]^2` with `t = |phi|`
/// (Sola, Deray, Atchuthan, arXiv:1812.01537, equation 146).
#[must_use]
pub fn rotation_vector_jacobian_inverse(phi: &Vec3) -> Matrix3<f64> {
    let skew = phi.cross_matrix();
    let t2 = phi.norm_squared();
    let factor = if t2 < 1e-8 {
        1.0 / 12.0 + t2 / 720.0
    } else {
        let t = t2.sqrt();
        1.0 / t2 - (1.0 + t.cos()) / (2.0 * t * t.sin())
    };
    Matrix3::identity() - skew * 0.5 + skew * skew * factor
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn difference_undoes_perturbation() {
        let pose = Pose::from_parts([0.1, -0.2, 0.3], [0.9, 0.1, -0.2, 0.3]);
        let twist = Twist::new(0.01, 0.02, -0.03, 0.2, -0.1, 0.4);
        let back = pose.perturbed(&twist).difference(&pose);
        assert!((back - twist).norm() < 1e-14);
    }

    #[test]
    fn rotation_vector_jacobian_matches_finite_differences() {
        for phi in [Vec3::new(0.3, -0.8, 0.5), Vec3::new(1e-5, 2e-5, -1e-5)] {
            let jacobian = rotation_vector_jacobian_inverse(&phi);
            let rotation = UnitQuaternion::from_scaled_axis(phi);
            let h = 1e-6;
            for k in 0..3 {
                let step = Vec3::ith(k, h);
                let plus = (UnitQuaternion::from_scaled_axis(step) * rotation).scaled_axis();
                let minus = (UnitQuaternion::from_scaled_axis(-step) * rotation).scaled_axis();
                let slope = (plus - minus) / (2.0 * h);
                assert!((slope - jacobian.column(k)).norm() < 1e-9);
            }
        }
    }
}

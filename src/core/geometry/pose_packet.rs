//! Poses in the form used by the kernels: plain numbers or SIMD lanes.

use nalgebra::{Quaternion, UnitQuaternion};
use pulp::Simd;

use super::Pose;
use crate::real::{Lanes, Packet, Real, cross, dot, scaled, square_norm};

/// The [`Pose`] of one platform (`T = f64`) or of one platform per SIMD lane.
///
/// The rotation matrix is kept beside the quaternion because a kernel rotates an anchor per cable with it, but
/// stores and moves the seven numbers of the quaternion form.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PosePacket<T> {
    /// Platform origin, base frame (m).
    pub position: [T; 3],
    /// Orientation, quaternion w first, of norm 1.
    pub quaternion: [T; 4],
    /// `rotation[row][column]` of the matrix from the platform to the base frame.
    pub rotation: [[T; 3]; 3],
}

impl<T: Real> PosePacket<T> {
    #[inline(always)]
    pub fn new(position: [T; 3], quaternion: [T; 4]) -> Self {
        let [w, x, y, z] = quaternion;
        let one = w.lift(1.0);
        let two = w.lift(2.0);
        let rotation = [
            [
                one - two * (y * y + z * z),
                two * (x * y - w * z),
                two * (x * z + w * y),
            ],
            [
                two * (x * y + w * z),
                one - two * (x * x + z * z),
                two * (y * z - w * x),
            ],
            [
                two * (x * z - w * y),
                two * (y * z + w * x),
                one - two * (x * x + y * y),
            ],
        ];
        Self {
            position,
            quaternion,
            rotation,
        }
    }

    /// Rotates a vector from the platform to the base frame.
    #[inline(always)]
    pub fn rotate(&self, v: [T; 3]) -> [T; 3] {
        let [x, y, z] = self.rotation;
        [dot(x, v), dot(y, v), dot(z, v)]
    }

    /// The pose after the small motion `[d, phi]`. The rotation is `1 + phi/2` as a quaternion, normalised:
    /// it agrees with the exponential to second order, and needs no trigonometry.
    #[inline(always)]
    pub fn moved(&self, step: [T; 6]) -> Self {
        let half = self.position[0].lift(0.5);
        let v = scaled([step[3], step[4], step[5]], half);
        let [w, x, y, z] = self.quaternion;
        let q = [x, y, z];
        let c = cross(v, q);
        let turned = [
            w - dot(v, q),
            v[0].mul_add(w, q[0]) + c[0],
            v[1].mul_add(w, q[1]) + c[1],
            v[2].mul_add(w, q[2]) + c[2],
        ];
        let inverse = half.lift(1.0) / square_norm(turned).sqrt();
        let position = [
            self.position[0] + step[0],
            self.position[1] + step[1],
            self.position[2] + step[2],
        ];
        Self::new(position, scaled(turned, inverse))
    }
}

impl PosePacket<f64> {
    /// The same pose in all lanes.
    // No closures here or wherever lanes are used: they would be compiled for the baseline processor.
    #[inline(always)]
    pub fn splat<S: Simd>(&self, simd: S) -> PosePacket<Lanes<S>> {
        let zero = Lanes::splat(simd, 0.0);
        let mut packet = PosePacket {
            position: [zero; 3],
            quaternion: [zero; 4],
            rotation: [[zero; 3]; 3],
        };
        for i in 0..3 {
            packet.position[i] = zero.lift(self.position[i]);
            for j in 0..3 {
                packet.rotation[i][j] = zero.lift(self.rotation[i][j]);
            }
        }
        for i in 0..4 {
            packet.quaternion[i] = zero.lift(self.quaternion[i]);
        }
        packet
    }
}

impl From<&Pose> for PosePacket<f64> {
    fn from(pose: &Pose) -> Self {
        let q = pose.orientation.quaternion();
        Self::new(pose.position.into(), [q.w, q.i, q.j, q.k])
    }
}

impl From<PosePacket<f64>> for Pose {
    fn from(packet: PosePacket<f64>) -> Self {
        let [w, x, y, z] = packet.quaternion;
        Self {
            position: packet.position.into(),
            orientation: UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Twist, Vec3};

    fn pose() -> Pose {
        Pose::from_parts([0.1, -0.2, 0.3], [0.9, 0.1, -0.2, 0.3])
    }

    #[test]
    fn rotates_as_the_pose_does_and_comes_back() {
        let packet = PosePacket::from(&pose());
        let point = Vec3::new(0.4, 0.5, -0.6);
        let rotated = Vec3::from(packet.rotate(point.into()));
        assert!((rotated - pose().orientation * point).norm() < 1e-15);
        assert!(Pose::from(packet).difference(&pose()).norm() < 1e-15);
    }

    #[test]
    fn small_motions_agree_to_second_order() {
        let direction = Twist::new(0.3, -0.1, 0.2, 0.5, -0.7, 0.4);
        let error = |size: f64| {
            let step = direction * size;
            let moved = Pose::from(PosePacket::from(&pose()).moved(step.into()));
            moved.difference(&pose().perturbed(&step)).norm()
        };
        assert!(error(1e-3) < 1e-9);
        assert!((error(2e-2) / error(1e-2) - 8.0).abs() < 0.1);
    }
}

//! Rotations, poses and the coordinates in which a platform is free to move.

mod freedom;
mod pose;
mod pose_packet;

pub use freedom::{Coordinate, Freedom};
pub use pose::{Pose, Twist, rotation_vector_jacobian_inverse};
pub(crate) use pose_packet::PosePacket;

/// A vector of three reals, metres unless said otherwise.
pub type Vec3 = nalgebra::Vector3<f64>;

//! Rotations, poses and the coordinates in which a platform is free to move.

mod freedom;
mod pose;

pub use freedom::{Coordinate, Freedom};
pub use pose::{Pose, Twist, rotation_vector_jacobian_inverse};

/// A vector of three reals, metres unless said otherwise.
pub type Vec3 = nalgebra::Vector3<f64>;

//! Cable and platform kinematics.

mod pulley;

pub use pulley::{CablePath, PathChange, PulleyGeometry};

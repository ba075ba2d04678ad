//! Cable and platform kinematics.

mod inverse;
mod pulley;
#[cfg(test)]
pub(crate) mod samples;
mod statics;

pub use inverse::{
    CableState, KinematicsError, LengthGradient, inverse_kinematics, length_gradients,
};
pub use pulley::{CablePath, PathChange, PulleyGeometry};
pub use statics::{
    Feasibility, TensionDistribution, applied_wrench, distribute_tension, equilibrium_residual,
    structure_matrix,
};

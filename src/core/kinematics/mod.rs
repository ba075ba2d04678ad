//! Cable and platform kinematics.

mod cable_arrays;
mod drawing;
mod forward;
mod inverse;
mod length_breakdown;
mod position_response;
mod pulley;
#[cfg(test)]
pub(crate) mod samples;
mod statics;

pub(crate) use cable_arrays::CableArrays;
pub use cable_arrays::MAX_CABLES;
pub use drawing::{CableDetail, CableDrawing, cable_polyline};
pub use forward::{ForwardKinematics, ForwardSolution};
pub(crate) use inverse::swivel_angle;
pub use inverse::{
    CableState, KinematicsError, LengthGradient, check_path_at, inverse_kinematics,
    length_gradients,
};
pub use length_breakdown::{
    LengthBreakdown, LengthBreakdownError, effective_geometry, length_breakdown,
};
pub(crate) use position_response::position_response;
pub use pulley::{CablePath, PathChange, PulleyGeometry};
pub use statics::{
    Feasibility, TensionDistribution, applied_wrench, distribute_tension, equilibrium_residual,
    structure_matrix,
};
pub(crate) use statics::{balanced_tension, resting_pose};

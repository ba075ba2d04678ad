//! Cable and platform kinematics.

mod bank;
mod budget;
mod drawing;
mod forward;
mod inverse;
mod pulley;
#[cfg(test)]
pub(crate) mod samples;
mod statics;

pub use bank::MAX_CABLES;
pub(crate) use bank::{CableBank, Placement};
pub use budget::{BudgetError, CableBudget, cable_budget};
pub use drawing::{CableDetail, CableDrawing, cable_polyline};
pub use forward::{ForwardKinematics, ForwardSolution};
pub use inverse::{
    CableState, KinematicsError, LengthGradient, check_path_at, inverse_kinematics,
    length_gradients,
};
pub use pulley::{CablePath, PathChange, PulleyGeometry};
pub use statics::{
    Feasibility, TensionDistribution, applied_wrench, distribute_tension, equilibrium_residual,
    structure_matrix,
};

//! Virtual robots that produce measurements, from the same prediction that the estimator uses.

mod loaded;
mod virtual_robot;
mod workspace;

pub use virtual_robot::{Simulated, SimulationError, SimulationOptions, TrueGeometry, simulate};
pub use workspace::{TensionRange, Workspace};

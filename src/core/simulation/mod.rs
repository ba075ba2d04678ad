//! Virtual robots that produce measurements, from the same prediction that the estimator uses.

mod loaded;
mod readings;
mod virtual_robot;
mod workspace;

pub(crate) use readings::{PlannedRow, planned_readings};
pub(crate) use virtual_robot::hold;
pub use virtual_robot::{Simulated, SimulationError, SimulationOptions, TrueGeometry, simulate};
pub(crate) use workspace::bounds;
pub use workspace::{TensionRange, Workspace};

//! Virtual robots that produce measurements, from the same prediction that the estimator uses.

mod inversion;
mod loaded;
mod readings;
mod standing;
mod virtual_robot;
mod workspace;

pub(crate) use loaded::hold_after_home;
pub use loaded::{Moment, ambient_temperature_c};
pub(crate) use readings::{PlannedRow, planned_readings};
pub use standing::{Rest, StandingRobot};
pub use virtual_robot::{
    Simulated, SimulationError, SimulationOptions, TrueGeometry, simulate, true_robot,
};
pub(crate) use workspace::bounds;
pub use workspace::{TensionRange, Workspace};

//! Virtual robots that produce measurements, from the same prediction that the estimator uses.

mod inversion;
mod loaded;
mod standing;
mod virtual_robot;
mod workspace;

pub use loaded::{Moment, ambient_temperature_c};
pub use standing::{Rest, StandingRobot};
pub use virtual_robot::{
    Simulated, SimulationError, SimulationOptions, TrueGeometry, simulate, true_robot,
};
pub use workspace::{TensionRange, Workspace};

//! Virtual robots: simulated measurements from the same prediction that the estimator uses.

mod holding_tensions;
mod inversion;
#[cfg(test)]
mod machines;
mod phase_tables;
mod quasi_static_robot;
mod readings;
mod recording;
mod repeated_runs;
mod trajectory;
mod virtual_robot;
mod workspace;

pub(crate) use holding_tensions::AfterHome;
pub use holding_tensions::{Epoch, ambient_temperature_c};
#[cfg(test)]
pub(crate) use machines::run_of_machine;
pub use phase_tables::{PhaseTables, approaches, phase_tables};
pub use quasi_static_robot::{QuasiStaticRobot, RestState};
pub(crate) use readings::{PlannedRow, planned_readings, true_directions};
pub use recording::{Recording, record};
pub use repeated_runs::RepeatedRuns;
pub use virtual_robot::{
    Simulated, SimulationError, SimulationOptions, TrueGeometry, draw_deviations, drawn_inputs,
    simulate, true_robot,
};
pub(crate) use workspace::bounds;
pub use workspace::{TensionRange, Workspace};

#[cfg(test)]
mod tests;

//! Phases 1 and 2 as commands and screens share them: fits of the tables, and what they put into the robot.

mod calibration;
mod fits;
mod put;
mod table;

pub use calibration::{Calibration, PerCable, Proposal};
pub use fits::{
    ElongationFit, fit_elongation, fit_force_sensor, fit_home, fit_winch, home_start_in_reference,
};
pub use put::{put_force_sensor, put_home, put_surface, put_winch};
pub use table::{Table, TableRows};

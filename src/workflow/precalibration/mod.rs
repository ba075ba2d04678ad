//! Phases 1 and 2 for commands and screens: fits of the tables, and the robot with the fitted values.

mod apply;
mod calibration;
mod document;
mod fits;
mod home;
mod table;

pub use calibration::{Calibration, PerCable, Proposal};
pub use document::{
    ElongationResult, Failure, ForceResult, HomeResult, Precalibration, WinchResult,
};
pub use fits::{ElongationFit, home_start_in_reference};
pub use home::HomeDocument;
pub use table::{Table, TableRows};

//! Studies: accuracy of calibration as a function of robot, sensors, poses, noise and faults.
//!
//! A study file describes cells. Most are predicted by the expected covariance alone; some are checked by simulated
//! calibrations, which run in chunks on any number of machines and are merged. The result depends neither on the division
//! into chunks nor on the machines: every calibration has its own random stream, and statistics are exact sums and counts.

pub mod calibration;
pub mod cell;
pub mod chunk;
pub mod design;
pub mod file;
mod merging;
mod monte_carlo;
pub mod plan;
pub mod report;
pub mod result;
pub mod run;
pub mod scaling;
pub mod simulated_question;
pub mod statistics;
pub mod which_sensor;

pub use file::StudyFile;
pub use merging::{RESULT, calibrations, merge, read_result};
pub use monte_carlo::{drawn_entry_points, monte_carlo};
pub use plan::{StudyPlan, read_plan};
pub use result::StudyResult;

/// Version of the program, stored in chunks: those of different versions are not merged.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");

/// Error of a study.
#[derive(Debug, thiserror::Error)]
pub enum StudyError {
    /// A file cannot be read or is invalid.
    #[error(transparent)]
    Read(#[from] tautline_files::ReadError),
    /// A file cannot be written.
    #[error(transparent)]
    Write(#[from] tautline_session::WriteError),
    /// Invalid input; one sentence with the place, what was found and what was expected.
    #[error("{0}")]
    Input(String),
    /// Cancelled; finished chunks are kept.
    #[error("cancelled: finished chunks are kept; start again to simulate the rest")]
    Cancelled,
}

/// Creates the folder of a study if it does not exist.
fn create_folder(folder: &std::path::Path) -> Result<(), StudyError> {
    std::fs::create_dir_all(folder).map_err(|error| {
        StudyError::Input(format!("{}: cannot be created ({error})", folder.display()))
    })
}

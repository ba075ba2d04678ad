//! Studies: how exact calibrations become, over robots, sensors, poses, noise and faults.
//!
//! A study file describes cells. Most are answered by the expected covariance alone; a part is checked by simulated
//! calibrations, which are done in chunks on any number of machines and merged. The result does not depend on how it was
//! cut nor on where it ran: every calibration has random numbers of its own, and statistics are exact sums and counts.

pub mod calibration;
pub mod cell;
pub mod chunk;
pub mod design;
pub mod file;
mod merging;
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
pub use plan::{StudyPlan, read_plan};
pub use result::StudyResult;

/// Version of the program, which chunks carry: those of different versions are not merged.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");

/// Why a study goes no further.
#[derive(Debug, thiserror::Error)]
pub enum StudyError {
    /// A file is not what it should be.
    #[error(transparent)]
    Read(#[from] tautline_session::ReadError),
    /// A file cannot be written.
    #[error(transparent)]
    Write(#[from] tautline_session::WriteError),
    /// What was asked for is impossible; one sentence with place, what was found and what was expected.
    #[error("{0}")]
    Input(String),
    /// It was cancelled; what is finished is kept.
    #[error("cancelled: finished chunks are kept, the rest is simulated when it is started again")]
    Cancelled,
}

/// The folder of a study, if it is not there yet.
fn create_folder(folder: &std::path::Path) -> Result<(), StudyError> {
    std::fs::create_dir_all(folder).map_err(|error| {
        StudyError::Input(format!("{}: cannot be created ({error})", folder.display()))
    })
}

//! Identification: problems, solver, summary.

mod double_double;
mod fit_statistics;
mod linear_fit;
mod pivoted_qr;

pub use fit_statistics::FitStatistics;
pub use linear_fit::{fit_linear, fit_polynomial};

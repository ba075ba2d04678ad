//! Measured data of a calibration run.

mod dataset;
mod local_polynomial;
mod noise_correlation;
mod recording;
mod standstill;
mod variable;

pub use dataset::{Dataset, Grid, Measurements, Truth};
pub use recording::{Rates, ReadingKind, Sampling};
pub use variable::Variable;

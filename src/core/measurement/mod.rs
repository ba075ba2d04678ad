//! Measured data of a calibration run.

mod dataset;
mod standstill;
mod variable;

pub use dataset::{Dataset, Grid, Measurements, Truth};
pub use variable::Variable;

//! Measured data of a calibration run.

mod dataset;

pub use dataset::{Dataset, Grid, Measurements, Truth};

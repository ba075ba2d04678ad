//! Measured data of a calibration run.

mod dataset;
mod distance;
mod local_polynomial;
mod noise_correlation;
mod recording;
mod smoothness;
mod standstill;
mod variable;

pub use dataset::{Dataset, Grid, Measurements, Truth};
pub use distance::DistanceReading;
pub use recording::{MostRows, Rates, ReadingKind, Sampling};
pub use smoothness::{SampledChannel, follows_a_motion};
pub use variable::Variable;

//! Phase 1 instruments: winches, force sensors, the home reference platform.

mod calibration_error;
mod distance_curve;
mod force_sensor;
mod home_average;
mod home_platform;
mod home_repeats;
mod winch;

pub use calibration_error::CalibrationError;
pub use distance_curve::{DistanceCurveFit, DistancePair, fit_distance_curve};
pub use force_sensor::{
    FORCE_RESIDUAL_LIMIT_N, ForcePair, ForceSensorCalibration, calibrate_force_sensor,
};
pub use home_average::{HomeAverage, HomeReading};
pub use home_platform::{HomeFix, HomePlatformError, locate_platform};
pub use home_repeats::{HomeMeasurement, SensorRepeats, measure_home};
pub use winch::{WINCH_RESIDUAL_LIMIT_M, WinchCalibration, WinchPair, calibrate_winch};

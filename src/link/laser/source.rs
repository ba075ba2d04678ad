//! The interface of laser distance sensors.

use crate::error::LinkError;

/// Longest plausible distance (m).
pub(super) const LONGEST_M: f64 = 1000.0;

/// A distance and its age.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LaserReading {
    /// Time since it was read (s).
    pub age_s: f64,
    /// Distance (m); `None` if the sensor reports no return.
    pub distance_m: Option<f64>,
}

/// A device that measures the laser distance. No call waits for a reading.
pub trait LaserSource: Send {
    /// Name shown to the operator.
    fn identity(&self) -> String;

    /// Connects if not connected.
    ///
    /// # Errors
    /// If the connection fails.
    fn connect(&mut self) -> Result<(), LinkError>;

    /// Ends the connection.
    fn disconnect(&mut self);

    /// The latest reading since the platform was sent to its present pose or the connection was made.
    fn latest(&self) -> Option<LaserReading>;

    /// Age beyond which a reading is no longer used (s).
    fn max_age_s(&self) -> f64;

    /// Discards the latest reading, because the platform leaves the pose it belongs to.
    fn discard_reading(&mut self);

    /// Reason why there is no distance, as one sentence.
    fn problem(&self) -> Option<String>;

    /// The distance (m), if it is recent, finite and not negative.
    fn distance_m(&self) -> Option<f64> {
        let reading = self.latest()?;
        let fresh = (0.0..=self.max_age_s()).contains(&reading.age_s);
        let distance_m = reading.distance_m.filter(|_| fresh)?;
        (distance_m.is_finite() && distance_m >= 0.0).then_some(distance_m)
    }
}

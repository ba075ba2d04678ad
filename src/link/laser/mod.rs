//! Laser distance sensors beside the controller.
//!
//! A [`LaserSource`] has the distance from another device than the controller: a [`crate::Station`] puts it into
//! the samples.

use crate::controller::LinkError;

/// A distance, and how old it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LaserReading {
    /// Time since it was read (s).
    pub age_s: f64,
    /// Distance (m); `None` where the sensor says that it has no return.
    pub distance_m: Option<f64>,
}

/// A device that measures the laser distance. No call waits for a reading.
pub trait LaserSource: Send {
    /// Name shown to the operator.
    fn identity(&self) -> String;

    /// Connects, unless it is connected.
    ///
    /// # Errors
    /// If there is no connection to be had.
    fn connect(&mut self) -> Result<(), LinkError>;

    /// Ends the connection.
    fn disconnect(&mut self);

    /// The latest reading since the platform was sent to its present place or the connection was made.
    fn latest(&self) -> Option<LaserReading>;

    /// Age from which a reading is not used any more (s).
    fn fresh_s(&self) -> f64;

    /// The platform is sent elsewhere: what was read belongs to the place before.
    fn leave(&mut self);

    /// What is wrong with the device, in one sentence.
    fn trouble(&self) -> Option<String>;

    /// The distance (m), where it is fresh, a number, and not negative.
    fn distance_m(&self) -> Option<f64> {
        let reading = self.latest()?;
        let fresh = (0.0..=self.fresh_s()).contains(&reading.age_s);
        let distance_m = reading.distance_m.filter(|_| fresh)?;
        (distance_m.is_finite() && distance_m >= 0.0).then_some(distance_m)
    }
}

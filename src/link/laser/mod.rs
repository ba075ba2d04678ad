//! External laser distance sensors.
//!
//! A [`LaserSource`] gets the distance from another device than the controller; a [`crate::GuardedController`] puts it
//! into the samples.

mod line;
mod lines;
mod manual;
mod port;

use std::sync::Arc;

use tautline_session::LaserSettings;

use crate::clock::Clock;
use crate::error::LinkError;

pub use line::LineLaser;
pub use manual::ManualLaser;
pub use port::serial_ports;

/// Longest plausible distance (m).
const LONGEST_M: f64 = 1000.0;

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
    /// If the device cannot be connected.
    fn connect(&mut self) -> Result<(), LinkError>;

    /// Ends the connection.
    fn disconnect(&mut self);

    /// The latest reading since the platform was sent to its present place or the connection was made.
    fn latest(&self) -> Option<LaserReading>;

    /// Age from which a reading is not used any more (s).
    fn max_age_s(&self) -> f64;

    /// The platform leaves: the latest reading belongs to the place before.
    fn discard_reading(&mut self);

    /// Why there is no distance, as one sentence.
    fn problem(&self) -> Option<String>;

    /// The distance (m), where it is fresh, a number, and not negative.
    fn distance_m(&self) -> Option<f64> {
        let reading = self.latest()?;
        let fresh = (0.0..=self.max_age_s()).contains(&reading.age_s);
        let distance_m = reading.distance_m.filter(|_| fresh)?;
        (distance_m.is_finite() && distance_m >= 0.0).then_some(distance_m)
    }
}

/// A laser that does not belong to the controller.
pub enum ExternalLaser {
    /// The operator types the distance: hand a clone to [`crate::measuring::MeasuringRun::asking`].
    Manual(ManualLaser),
    /// A device sends it.
    Line(Box<LineLaser>),
}

impl ExternalLaser {
    /// The laser of these settings, not connected; `None` where it is the controller's own.
    #[must_use]
    pub fn of(settings: &LaserSettings, clock: Arc<dyn Clock>) -> Option<Self> {
        match settings {
            LaserSettings::Controller => None,
            LaserSettings::Manual => Some(Self::Manual(ManualLaser::default())),
            LaserSettings::Line(line) => {
                Some(Self::Line(Box::new(LineLaser::new(line.clone(), clock))))
            }
        }
    }

    /// The laser whose distance the operator types.
    #[must_use]
    pub fn manual(&self) -> Option<ManualLaser> {
        match self {
            Self::Manual(laser) => Some(laser.clone()),
            Self::Line(_) => None,
        }
    }

    /// For [`crate::GuardedController::with_laser`].
    #[must_use]
    pub fn into_source(self) -> Box<dyn LaserSource> {
        match self {
            Self::Manual(laser) => Box::new(laser),
            Self::Line(laser) => laser,
        }
    }
}

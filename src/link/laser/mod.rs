//! Laser distance sensors beside the controller.
//!
//! A [`LaserSource`] has the distance from another device than the controller: a [`crate::Station`] puts it into
//! the samples.

mod line;
mod lines;
mod manual;
mod port;

use std::sync::Arc;

use tautline_session::LaserSettings;

use crate::clock::Clock;
use crate::controller::LinkError;

pub use line::LineLaser;
pub use manual::ManualLaser;
pub use port::serial_ports;
pub use tautline_session::LaserSettings as LaserChoice;

/// Longest distance that is believed (m).
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

/// The laser that settings ask for, not connected; `None` where it is the controller's own.
#[must_use]
pub fn chosen(choice: &LaserChoice, clock: Arc<dyn Clock>) -> Option<Chosen> {
    match choice {
        LaserSettings::Controller => None,
        LaserSettings::Manual => Some(Chosen::Manual(ManualLaser::default())),
        LaserSettings::Line(line) => {
            let laser = LineLaser::new(line.clone(), clock);
            Some(Chosen::Line(Box::new(laser)))
        }
    }
}

/// A laser beside the controller.
pub enum Chosen {
    /// The operator types the distance: hand a clone to [`crate::measuring::MeasuringRun::asking`].
    Manual(ManualLaser),
    /// A device sends it.
    Line(Box<LineLaser>),
}

impl Chosen {
    /// The laser to which the operator answers.
    #[must_use]
    pub fn asked(&self) -> Option<ManualLaser> {
        match self {
            Self::Manual(laser) => Some(laser.clone()),
            Self::Line(_) => None,
        }
    }

    /// For [`crate::Station::with_laser`].
    #[must_use]
    pub fn into_source(self) -> Box<dyn LaserSource> {
        match self {
            Self::Manual(laser) => Box::new(laser),
            Self::Line(laser) => laser,
        }
    }
}

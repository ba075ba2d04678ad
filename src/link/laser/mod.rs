//! External laser distance sensors.
//!
//! A [`LaserSource`] gets the distance from a device other than the controller; a [`crate::GuardedController`] adds it
//! to the samples.

mod line;
mod manual;
mod port;
mod source;

use std::sync::Arc;

use tautline_session::LaserSettings;

use crate::clock::Clock;

pub use line::LineLaser;
pub use manual::ManualLaser;
pub use port::serial_ports;
pub use source::{LaserReading, LaserSource};

/// A laser that is not connected to the controller.
pub enum ExternalLaser {
    /// The operator types the distance; pass a clone to [`crate::measuring::MeasuringRun::asking`].
    Manual(ManualLaser),
    /// A device sends the distance.
    Line(Box<LineLaser>),
}

impl ExternalLaser {
    /// The laser with these settings, not connected; `None` if it is read by the controller.
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

    /// The laser whose distance is typed by the operator.
    #[must_use]
    pub fn manual(&self) -> Option<ManualLaser> {
        match self {
            Self::Manual(laser) => Some(laser.clone()),
            Self::Line(_) => None,
        }
    }

    /// Converts it for [`crate::GuardedController::with_laser`].
    #[must_use]
    pub fn into_source(self) -> Box<dyn LaserSource> {
        match self {
            Self::Manual(laser) => Box::new(laser),
            Self::Line(laser) => laser,
        }
    }
}

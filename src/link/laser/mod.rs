//! External laser distance sensors.
//!
//! A [`LaserSource`] gets the distance from another device than the controller; a [`crate::GuardedController`] puts it
//! into the samples.

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

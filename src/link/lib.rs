//! Controllers and instruments: commands to a robot and readings from it.
//!
//! Everything here is driven by its caller. Nothing draws, and the only blocking calls wait for the response of
//! a real controller, for a bounded time. Time comes from the samples of a controller and from the caller. A device that
//! sends on its own is read by a thread, which a connection starts and ends.

pub mod adjusting;
pub mod ads;
pub mod clock;
pub mod controller;
pub mod error;
pub mod export;
pub mod guarded;
pub mod laser;
pub mod limits;
pub mod measuring;
pub mod opcua;
pub mod parameters;
pub mod pose_tracker;
pub mod reconnecting;
pub mod replay;
pub mod simulated;
pub mod symbols;
#[cfg(test)]
mod testing;
mod timed_socket;
pub mod verifying;

pub use clock::{Clock, ManualClock, SystemClock};
pub use controller::{Activity, Controller, ControllerState, Instrument, LinkProtection, Sample};
pub use error::{LinkError, UntrustedServer};
pub use guarded::{GuardedController, LastState};
pub use laser::LaserSource;
pub use limits::Limits;
pub use parameters::ParameterInfo;
pub use pose_tracker::PoseTracker;
pub use replay::ReplayController;

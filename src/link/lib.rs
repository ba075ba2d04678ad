//! Controllers and instruments: what is told to a robot and what is read from it.
//!
//! Everything here is driven by its caller: nothing waits, starts a thread or draws. Time comes from the
//! samples of a controller and from the caller.

pub mod adjusting;
pub mod clock;
pub mod controller;
pub mod export;
pub mod limits;
pub mod measuring;
pub mod parameters;
pub mod replay;
pub mod simulated;
#[cfg(test)]
mod testing;
pub mod verifying;

pub use clock::{Clock, ManualClock, SystemClock};
pub use controller::{Activity, Controller, ControllerState, Instrument, LinkError, Sample};
pub use limits::{Limited, Limits};
pub use parameters::ParameterInfo;
pub use replay::ReplayController;

//! Controllers and instruments: what is told to a robot and what is read from it.
//!
//! Everything here is driven by its caller: nothing starts a thread or draws, and nothing waits but for the answer
//! of a real controller, for a bounded time. Time comes from the samples of a controller and from the caller.

pub mod adjusting;
pub mod ads;
pub mod clock;
pub mod controller;
pub mod export;
pub mod limits;
pub mod measuring;
pub mod parameters;
pub mod reconnecting;
pub mod simulated;
#[cfg(test)]
mod testing;
pub mod verifying;

pub use clock::{Clock, ManualClock, SystemClock};
pub use controller::{Activity, Controller, ControllerState, Instrument, LinkError, Sample};
pub use limits::{Limited, Limits};
pub use parameters::ParameterInfo;

//! Controllers and instruments: what is told to a robot and what is read from it.
//!
//! Everything here is driven by its caller: nothing draws, and nothing waits but for the answer of a real controller,
//! for a bounded time. Time comes from the samples of a controller and from the caller. What a device sends when it
//! likes is read by a thread of its own, which a connection starts and ends.

pub mod adjusting;
pub mod ads;
pub mod clock;
pub mod controller;
pub mod export;
pub mod laser;
pub mod limits;
pub mod measuring;
pub mod parameters;
pub mod reconnecting;
pub mod replay;
pub mod simulated;
pub mod station;
#[cfg(test)]
mod testing;
pub mod verifying;

pub use clock::{Clock, ManualClock, SystemClock};
pub use controller::{Activity, Controller, ControllerState, Instrument, LinkError, Sample};
pub use laser::LaserSource;
pub use limits::Limits;
pub use parameters::ParameterInfo;
pub use replay::ReplayController;
pub use station::Station;

//! Controllers with their limits, instruments and clocks, for window and commands alike.
//!
//! A [`ConnectionSetup`] describes a connection; [`ConnectionSetup::open`] opens it: the controller behind its limits, the
//! external instrument that belongs to it, and the clock that drives it.

mod choice;
mod clock;
mod held_values;
mod opened;
mod setup;

pub use choice::{ControllerChoice, ControllerChoiceError};
pub use clock::SimulationClock;
pub use held_values::{beside, held_values};
pub use opened::{OpenError, Opened};
pub use setup::{ConnectionSetup, Kind, bounds};

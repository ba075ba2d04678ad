//! Controllers with their limits, instruments and clocks, for window and commands alike.
//!
//! A [`ConnectionSetup`] describes a connection; [`ConnectionSetup::open`] opens it: the controller behind its limits, the
//! external instrument that belongs to it, and the clock that drives it.

mod choice;
mod clock;
mod opened;
mod setup;
mod stored;
mod symbols;

pub use choice::{ControllerChoice, ControllerChoiceError};
pub use clock::SimulationClock;
pub use opened::{OpenError, Opened};
pub use setup::{ConnectionSetup, Kind};
pub use stored::{beside, held_values, is_held_values};
pub use symbols::check_symbols;

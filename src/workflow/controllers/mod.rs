//! Controllers with their limits, instruments and clocks, for window and commands alike.
//!
//! A [`ConnectionSetup`] describes a connection; [`ConnectionSetup::open`] opens it and returns the controller guarded by its
//! limits, its external instrument, and its clock.

mod choice;
mod clock;
mod opened;
mod setup;
mod stored;
mod symbols;
mod user_keys;

pub use choice::{ControllerChoice, ControllerChoiceError};
pub use clock::SimulationClock;
pub use opened::{OpenError, Opened};
pub use setup::{ConnectionSetup, RobotKind};
pub use stored::{beside, held_values, is_held_values};
pub use symbols::check_symbols;
pub use user_keys::{PASSWORD, UserKeys};

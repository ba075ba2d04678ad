//! Controllers, put together: the same for the window and for the commands.
//!
//! A [`Rig`] says what a connection is made of; [`Rig::open`] makes it: the controller behind its limits, the external
//! instrument that belongs to it, and the clock that its time comes from.

mod choice;
mod clock;
mod opened;
mod rig;
mod stored;

pub use choice::{ControllerChoice, NoChoice};
pub use clock::FastClock;
pub use opened::{OpenError, Opened};
pub use rig::{Kind, Rig, bounds};
pub use stored::{beside, stored_at};

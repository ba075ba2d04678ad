//! The built program in a real window on a virtual screen, for tests and for measuring its speed.

mod display;
mod running;
pub mod speed;

pub use display::{Display, keys};
pub use running::{Element, Window};

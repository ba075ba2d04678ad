//! The demonstration session and the sample sessions.

mod demo;
mod library;
pub mod tables;

pub use demo::demo;
pub use library::{Sample, find, places};

//! Sessions that the program makes itself: the demonstration and the samples to open and look at.

mod demo;
mod library;
pub mod tables;

pub use demo::demo;
pub use library::{Sample, find, places};

//! Sessions that the program makes itself: the demonstration and the samples to open and look at.

mod demo;
mod tables;

pub use demo::demo;

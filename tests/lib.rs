//! Suites across crates, and what they need.

pub mod generators;
pub mod support;
pub mod tables;

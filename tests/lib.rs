//! Suites across crates, with their support, generators and tables.

pub mod generators;
pub mod support;
pub mod tables;

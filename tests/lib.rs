//! Helpers of the cross-crate suites.

pub mod nist;

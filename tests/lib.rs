//! Helpers of the cross-crate suites.

pub mod bad_input_cases;
pub mod nist;
pub mod truth;

//! Virtual robots that produce measurements.

//! Accuracy figures of ISO 9283.

pub mod iso9283;

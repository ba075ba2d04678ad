//! Accuracy figures of ISO 9283.

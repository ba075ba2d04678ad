//! Comparison with independent references.

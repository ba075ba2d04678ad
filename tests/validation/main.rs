//! Comparison with independent references.

mod published;

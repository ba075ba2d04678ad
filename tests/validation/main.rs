//! Comparison with independent references.

mod nist;
mod published;

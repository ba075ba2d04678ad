//! Comparison with independent references.

mod nist;

//! Controllers and instruments.

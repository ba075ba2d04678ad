//! Results as documents and in words: the same for the commands, the screens and the sessions that keep them.

pub mod diagnosis;
pub mod identification;

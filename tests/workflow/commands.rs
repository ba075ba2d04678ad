//! The commands, run as separate programs.

mod accuracy;
mod errors;
mod identify;
mod precalibrate;
mod program;

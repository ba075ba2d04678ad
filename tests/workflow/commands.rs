//! The commands, run as separate programs.

mod accuracy;
mod diagnose;
mod errors;
mod identify;
mod precalibrate;
mod program;

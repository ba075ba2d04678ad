//! The commands, run as separate programs.

mod accuracy;
mod compare;
mod diagnose;
mod errors;
mod identify;
mod plan;
mod precalibrate;
mod program;
mod report;

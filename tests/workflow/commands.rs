//! The commands, run as separate programs.

mod accuracy;
mod check;
mod compare;
mod diagnose;
mod errors;
mod identify;
mod import;
mod plan;
mod precalibrate;
pub mod program;
mod report;

//! The commands, run as separate programs.

mod accuracy;
mod check;
mod command_line;
mod compare;
mod diagnose;
mod dialects;
mod errors;
mod formulas;
mod gallery;
mod health;
mod history;
mod hypotheses;
mod identify;
mod import;
mod plan;
mod precalibrate;
pub mod program;
mod replay;
mod report;

//! Identification: problems, solver, summary.

pub mod published;

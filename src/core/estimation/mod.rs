//! Identification: problems, solver, summary.

//! The workbench, driven by accessible names.

mod doctor;
mod identification;
mod measured;
mod start;
mod support;

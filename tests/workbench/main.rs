//! The workbench, driven by accessible names.

mod modeling;
mod precalibration;
mod start;
mod support;
mod tables;

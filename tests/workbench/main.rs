//! The workbench, driven by accessible names.

mod doctor;
mod gl;
mod identification;
mod measured;
mod modeling;
mod plots;
mod precalibration;
mod robot_3d;
mod start;
mod support;
mod tables;

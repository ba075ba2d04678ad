//! The workbench, driven by accessible names.

mod crash;
mod doctor;
mod gl;
mod identification;
mod measured;
mod modeling;
mod plots;
mod precalibration;
mod renderer;
mod robot_3d;
mod start;
mod support;
mod tables;

//! The workbench, driven by accessible names.

mod gl;
mod renderer;
mod robot_3d;
mod plots;
mod start;
mod support;

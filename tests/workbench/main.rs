//! The workbench, driven by accessible names.

mod gl;
mod renderer;
mod robot_3d;
mod start;
mod support;

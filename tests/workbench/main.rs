//! The workbench, driven by accessible names.

mod adjustment;
mod demo;
mod gl;
mod measuring;
mod renderer;
mod robot_3d;
mod plots;
mod start;
mod support;

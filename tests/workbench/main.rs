//! The workbench, driven by accessible names.

mod plots;
mod start;
mod support;

//! The workbench, driven by accessible names.

mod start;
mod support;

//! The Tautline program: workbench and headless commands.

pub mod cli;

//! The Tautline program: workbench and headless commands.

pub mod app;
pub mod cli;
pub mod samples;
mod screens;
mod views;
mod widgets;

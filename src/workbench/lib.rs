//! The Tautline program: workbench and headless commands.

pub mod app;
pub mod cli;
mod precalibration;
mod screens;
mod views;
mod widgets;

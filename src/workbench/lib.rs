//! The Tautline program: workbench and headless commands.

pub mod app;
pub mod cli;
pub mod documents;
pub mod offscreen;
pub mod samples;
mod screens;
pub mod views;
mod widgets;
mod wording;

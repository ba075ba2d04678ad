//! The Tautline program: workbench and headless commands.

pub mod app;
pub mod cli;
pub mod documents;
mod screens;
mod views;
mod widgets;
mod wording;

//! The Tautline program: workbench and headless commands.

mod adjusting;
pub mod app;
pub mod cli;
mod comparison;
pub mod controllers;
pub mod documents;
mod fonts;
pub mod offscreen;
pub mod planning;
mod precalibration;
pub mod report;
pub mod samples;
mod screens;
pub mod session_file;
pub mod views;
mod widgets;
mod wording;

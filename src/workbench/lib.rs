//! The Tautline program: the window.

pub mod app;
pub mod offscreen;
pub mod report_picture;
mod screens;
pub mod views;
mod widgets;

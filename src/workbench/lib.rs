//! The Tautline program: the window.

mod commands;
pub mod model;
mod screens;
pub mod shell;
pub mod theme;
pub mod views;
mod widgets;
